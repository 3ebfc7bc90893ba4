"""Write trajectories as YAML and JSON text."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, Literal

from yarclang.export.numbers import number, row, text, texts
from yarclang.export.ros.course import Between
from yarclang.export.ros.exported import Exported
from yarclang.export.ros.sampling import Points
from yarclang.progress import go_on

Version = Literal[1, 2]

SECOND = 1_000_000_000
"""Number of nanoseconds in a second."""


def yaml_text(made: Exported, version: Version) -> str:
    """Return trajectories as YAML documents, for `rostopic pub -f`.

    Each document is a trajectory_msgs/JointTrajectory. All other information is in comments.
    """
    lines = [f"# {line}" for line in about(made)]
    for at in range(made.size):
        go_on()
        if at:
            lines.append("---")
        lines += [f"# before it: {_line(one.text)}" for one in made.before(at)]
        lines.append(
            f"# trajectory {at + 1} of {made.size}, {made.starts[at]:.6f} s after the start, waits not "
            f"counted"
        )
        lines += [f"# during it, {one.time:.6f} s after its start: {_doing(one)}" for one in made.during(at)]
        lines += _trajectory(made, made.trajectory(at), version)
    lines += [f"# after it: {_line(one.text)}" for one in made.before(made.size)]
    return "\n".join(lines) + "\n"


def json_text(made: Exported, version: Version) -> str:
    """Return trajectories as the text of a JSON object, with the events between and during them."""
    parts: list[dict[str, Any]] = []
    for at in range(made.size):
        go_on()
        parts.append(
            {
                "before": [between_json(one) for one in made.before(at)],
                "during": [between_json(one) for one in made.during(at)],
                "start_s": round(made.starts[at], 9),
                "trajectory": message(made, made.trajectory(at), version),
            }
        )
    whole = {
        "format": "trajectory_msgs/JointTrajectory",
        "ros": version,
        **facts(made),
        "trajectories": parts,
        "after": [between_json(one) for one in made.before(made.size)],
    }
    return json.dumps(whole, indent=1) + "\n"


def facts(made: Exported) -> dict[str, Any]:
    """Return the origin and the proof of trajectories as plain data."""
    return {
        "program": made.program,
        "program_sha256": made.fingerprint,
        "controller_text_sha256": made.seal,
        "robot": made.robot.name,
        "robot_sha256": made.robot.fingerprint,
        "tolerance": made.wishes.tolerance,
        "units": ["m" if sliding else "rad" for sliding in made.robot.chain.is_prismatic.tolist()],
        "interpolations": {
            kind: {"proved_deviation": [float(f"{one:.4g}") for one in bound.tolist()]}
            for kind, bound in made.proved.items()
        },
    }


def about(made: Exported) -> Iterator[str]:
    """Yield comment lines about the origin and the proof of trajectories."""
    unit = " or ".join(dict.fromkeys(facts(made)["units"]))
    yield f"{_line(made.program)}: the motion that yarcc has certified, as trajectory_msgs/JointTrajectory"
    yield f"program {made.fingerprint}, controller text {made.seal}"
    yield f"robot {made.robot.name} {made.robot.fingerprint}"
    kinds = ", ".join(f"{kind} (at most {bound.max():.3g})" for kind, bound in made.proved.items())
    yield (
        f"tolerance {number(made.wishes.tolerance)} {unit}, proved for each joint at every instant if "
        f"the driver interpolates: {kinds}"
    )
    yield (
        "cubic: through positions and velocities; quintic: through accelerations too, if there are any, "
        "as ros_control does"
    )
    if not made.wishes.straight:
        yield (
            "a driver that goes in straight lines from point to point isn't within it: export with "
            "--linear for such a one"
        )


def message(made: Exported, points: Points, version: Version) -> dict[str, Any]:
    """Return waypoints as the fields of a JointTrajectory."""
    whole, part = _TIME[version]
    stamp = {whole: 0, part: 0}
    header: dict[str, Any] = {"seq": 0} if version == 1 else {}
    return {
        "header": {**header, "stamp": stamp, "frame_id": ""},
        "joint_names": list(made.robot.joint_names),
        "points": [
            {
                "positions": x,
                "velocities": v,
                "accelerations": a,
                "effort": [],
                "time_from_start": {whole: time // SECOND, part: time % SECOND},
            }
            for x, v, a, time in _rows(points)
        ],
    }


_TIME: dict[Version, tuple[str, str]] = {1: ("secs", "nsecs"), 2: ("sec", "nanosec")}


def _rows(points: Points) -> Iterator[tuple[list[float], list[float], list[float], int]]:
    return zip(points.x.tolist(), points.v.tolist(), points.a.tolist(), points.time.tolist(), strict=True)


def _trajectory(made: Exported, points: Points, version: Version) -> Iterator[str]:
    whole, part = _TIME[version]
    seq = "seq: 0, " if version == 1 else ""
    yield f"header: {{{seq}stamp: {{{whole}: 0, {part}: 0}}, frame_id: {text('')}}}"
    yield f"joint_names: {texts(made.robot.joint_names)}"
    yield "points:"
    for x, v, a, time in _rows(points):
        yield f"- positions: {row(x)}"
        yield f"  velocities: {row(v)}"
        yield f"  accelerations: {row(a)}"
        yield "  effort: []"
        yield f"  time_from_start: {{{whole}: {time // SECOND}, {part}: {time % SECOND}}}"


def between_json(one: Between) -> dict[str, Any]:
    """Return an event between or during trajectories as plain data."""
    time = {} if one.time is None else {"time_s": round(one.time, 9)}
    return {"kind": one.kind, "command": one.place, "what": one.what, **time}


def _doing(one: Between) -> str:
    return _line(f"{one.place}: {one.what}" if one.place else one.what)


def _line(said: str) -> str:
    """Return a text for one line of a comment: line breaks and unprintable characters become question
    marks.
    """
    return "".join(letter if letter.isprintable() else "?" for letter in said)
