"""Random programs with all motions, profiles, times and blends."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from yarclang.campaign import timetables
from yarclang.independent.arm import Arm, Array, Pose
from yarclang.independent.paths import Said
from yarclang.independent.timetable import numbers

PROFILES = ("", "_LSPB", "_POLY5", "_SCURVE", "_TOPP")
TIMES = ("[MIN]", "[MIN]", "[4.7]", "[3]", "[6]", "[5]", "[50%]")
SPEEDS = ("[V 20]", "[V 50]", "[V 80]")
"""Speeds of Cartesian motions in random programs. Slower speeds would give motions with thousands of
segments, which take long and test nothing new.
"""

BENT = {
    "INDUSTRIAL6": np.array([0, -5, -20, 10, 40, 0]),
    "TIAGO": np.array([100, 20, 0, 0, 0, 0, 0, 0]),
}
"""For arms that can't move freely around HOME: offsets from HOME to the position around which programs are
drawn [deg, mm]. At HOME, the wrist of INDUSTRIAL6 is straight, and the shoulder of TIAGO is beside its
column, which is low there.
"""

KINDS = (
    "joints",
    "joints_to_pose",
    "joint_delta",
    "joint_spline",
    "line",
    "line",
    "delta",
    "arc",
    "pose_spline",
)


@dataclass
class Drawn:
    """A program's text, and the requirements on each of its motions, by step."""

    text: str
    said: dict[int, Said]


def drawn(arm: Arm, random: np.random.Generator, most: int = 5) -> Drawn:
    """Draw a program of a few motions around the arm's middle position."""
    middle = middle_of(arm)
    room = np.minimum(arm.upper - middle, middle - arm.lower)
    (point,), turns = arm.poses(middle[None])
    reach = np.linalg.norm(point) / 10.0
    lines, said = begun(arm, middle)
    step = len(said)
    # Limit the distance of waypoints. If a joint can turn by more than a revolution, waypoints anywhere in
    # its range would make nearly every spline collide with the arm itself.
    spread = np.where(room > 180.0, 100.0, room)
    can_follow = len(middle) >= 6
    # Keep the goals of arms with many joints nearer. Otherwise most programs would be refused, because one of
    # the joints reaches a limit.
    near = 0.5 if len(middle) > 7 else 1.0
    reach *= near

    poses = 0

    def written(shift: Array, rpy: Array) -> str:
        """Return the numbers of a pose as text for a command. Two thirds of the poses are written indirectly:
        by the name of a POSE, or as elements of a TABLE.
        """
        nonlocal poses
        text = numbers([*shift, *rpy])
        if step % 3 == 2:
            return text
        poses += 1
        if step % 3 == 1:
            lines.append(f"TABLE VALUES{poses} {text}")
            return " ".join(f"$(VALUES{poses}[{number}])" for number in range(6))
        lines.append(f"POSE AT{poses} {text}")
        return f"AT{poses}"

    def pose(size: float = 1.0) -> tuple[Array, Array, Pose]:
        shift = np.round(point + random.uniform(-1, 1, 3) * reach * size, 3)
        rpy = np.round(turns[0].as_euler("xyz", degrees=True) + random.uniform(-25, 25, 3) * size * near, 3)
        return shift, rpy, (shift, Rotation.from_euler("xyz", rpy, degrees=True))

    for _ in range(random.integers(1, most + 1)):
        kind = str(random.choice(KINDS if can_follow else ("joints", "joint_delta", "joint_spline")))
        profile = str(random.choice(PROFILES))
        time = str(random.choice(TIMES))
        of_frame = kind in ("line", "delta", "arc", "pose_spline")
        if of_frame and profile in ("", "_LSPB", "_SCURVE") and random.random() < 0.25:
            time = str(random.choice(SPEEDS))
        elif time == "[MIN]" and step % 3 == 1:
            time = f"[V<={40 + 30 * (step % 4)}]"
        common: dict[str, Any] = {"profile": profile[1:] or "LSPB", "time": time}
        if kind in ("joints", "joint_delta"):
            size = random.choice([0.05, 0.3, 0.8])
            away = np.round(random.uniform(-1, 1, len(middle)) * room * size, 4)
            if kind == "joints":
                goal = np.round(middle + away, 4)
                words, one = f"MOVEJ{profile} {numbers(goal)}", Said("joints", [goal], **common)
            else:
                away = np.round(away * 0.2, 4)
                words = f"DMOVEJ{profile} {numbers(away)}"
                one = Said("joints", [away], relative=True, **common)
        elif kind == "joint_spline":
            goals = [
                np.round(middle + random.uniform(-1, 1, len(middle)) * spread * 0.4, 4)
                for _ in range(random.integers(2, 5))
            ]
            words = f"MOVEJ_SPLINE{profile} {'; '.join(map(numbers, goals))}"
            one = Said("joint_spline", goals, **common)
        elif kind == "joints_to_pose":
            shift, rpy, goal = pose()
            words = (
                f"MOVEJ{'_RPY' if step % 2 else ''}{profile} {written(shift, rpy)}"
                if step % 3 == 0
                else f"MOVEJ_RPY{profile} {numbers([*shift, *rpy])}"
            )
            one = Said("joints", [goal], **common)
        elif kind == "line":
            shift, rpy, goal = pose()
            words, one = f"MOVEL{profile} {written(shift, rpy)}", Said("line", [goal], **common)
        elif kind == "delta":
            shift = np.round(random.uniform(-1, 1, 3) * reach * 0.5, 3)
            rpy = np.round(random.uniform(-12, 12, 3) * near, 3)
            words = f"DMOVE{profile} {numbers([*shift, *rpy])}"
            goal = (shift, Rotation.from_euler("xyz", rpy, degrees=True))
            one = Said("line", [goal], relative=True, **common)
        elif kind == "arc":
            via = pose(0.7)[0]
            shift, rpy, goal = pose(0.7)
            words = f"MOVEC{profile} {numbers(via)}; {written(shift, rpy)}"
            one = Said("arc", [goal], via=via, **common)
        else:
            through = [pose(0.6) for _ in range(random.integers(2, 5))]
            values = "; ".join(written(shift, rpy) for shift, rpy, _ in through)
            words = f"MOVEL_SPLINE{profile} {values}"
            one = Said("pose_spline", [goal for _, _, goal in through], **common)
        options = ""
        if random.random() < 0.15:
            one.acc = float(random.choice([0.3, 0.6]))
            options += f" ACC {one.acc * 100:g}%"
        if random.random() < 0.55:
            one.blend = float(random.choice([0.3, 1, 3, 8, 20]))
            options += f" BLEND {'<=' * (step % 3 == 0)}{one.blend:g}"
        base = " {TCP}" if kind == "delta" else ""
        lines.append(f"P{(step + 1) * 10:04d} {words} {time}{base}{options}")
        said[step] = one
        step += 1
        if random.random() < 0.15:
            state, index = random.choice(["ON", "OFF"]), f"P{(step + 1) * 10:04d}"
            # A PULSE has three steps, in all of which the robot is at rest. It is used instead of SET if the
            # step's number is divisible by 4.
            is_pulse = step % 4 == 0
            lines.append(f"{index} PULSE LAMP [0.2]" if is_pulse else f"{index} SET LAMP {state}")
            step += 3 if is_pulse else 1
    if random.random() < 0.25:
        # The timetable begins at the middle position, wherever the motions before end. Nothing flows into a
        # WAIT.
        lines.append(f"P{(step + 1) * 10:04d} WAIT [0.1]")
        step += 1
        lines.append(f"P{(step + 1) * 10:04d} MOVEJ {numbers(middle)} [MIN]")
        said[step] = Said("joints", [np.round(middle, 4)])
        table = timetables.drawn(arm, random, str(random.choice(timetables.KINDS)), np.round(middle, 4))
        stretch = float(random.choice([3.0, 4.5]))
        option = f" STRETCH {stretch:g}"
        lines.append(f"P{(step + 2) * 10:04d} MOVEJ_TIMED {table.way()}{option}")
        said[step + 1] = Said("timed", list(table.rows), table=table, stretch=stretch)
    # Let some programs watch an input. This doesn't depend on a random number, so that the programs of known
    # seeds stay the same.
    if len(lines) % 3 == 0:
        lines[:0] = ["INPUT CURTAIN M11", "ON CURTAIN OFF HOLD"]
    return Drawn("\n".join(lines) + "\n", said)


def begun(arm: Arm, middle: Array) -> tuple[list[str], dict[int, Said]]:
    """Return the first lines of a program, which move the robot to the middle position; and, by step, the
    requirements on the motions in these lines.
    """
    lines = ["OUTPUT LAMP M1 OFF", "DEFAULT {TCP} (mm,deg,s) {B}"]
    if (middle == arm.data["positions"]["HOME"]).all():
        return lines, {}
    return [*lines, f"P0001 MOVEJ {numbers(middle)} [MIN]"], {0: Said("joints", [np.round(middle, 4)])}


def features(program: Drawn) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield for each motion of a program its step and the names under which it is counted: the kind of the
    motion, its motion profile, what its time is given by (a duration, a speed or a ceiling), and its options.

    The BLEND of the last motion isn't counted, because no motion follows.
    """
    steps = sorted(program.said)
    for step in steps:
        one = program.said[step]
        to_pose = one.kind == "joints" and isinstance(one.goals[-1], tuple)
        kind = f"{one.kind}{' of a pose' if to_pose else ''}{' by an increment' if one.relative else ''}"
        if one.speed is not None:
            time = "speed"
        elif one.ceiling is not None:
            time = "ceiling"
        elif one.seconds is not None:
            time = "seconds"
        else:
            time = "share" if one.share < 1.0 else "shortest time"
        # The last drawn motion flows into none: the program ends after it, or a WAIT and a timetable follow.
        flows = step != (steps[-3] if program.said[steps[-1]].kind == "timed" else steps[-1])
        beside = {"ACC": one.acc < 1.0, "BLEND": one.blend is not None and flows}
        beside |= {"_AVOID": one.avoids, "KEEP": bool(one.rules)}
        if one.kind == "timed":
            yield step, ("motions", kind)
            continue
        yield step, ("motions", kind, one.profile, time, *(name for name, said in beside.items() if said))


def middle_of(arm: Arm) -> Array:
    """Return the joint positions (n,) [deg, mm] around which programs are drawn."""
    home = np.array(arm.data["positions"]["HOME"], float)
    return np.asarray(home + BENT.get(arm.data["name"], 0.0))
