"""Format differences of two programs, as text and as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from yarclang.decisions import Watch
from yarclang.pipeline.executed import Act, Executed
from yarclang.report.comparison.compared import Compared, Comparison
from yarclang.report.comparison.path_difference import PathDifference
from yarclang.robot.model import Robot
from yarclang.runtime.signals import state_text
from yarclang.units import DEG, MM

_SIGNS = {"same": " ", "changed": "~", "added": "+", "removed": "-"}


def compared_lines(comparison: Comparison, *, all_commands: bool = False) -> Iterator[tuple[str, str]]:
    """Yield a sign and a line of text for each difference of two programs, then lines with the totals,
    without a sign.

    The signs are ~ for a changed command, + for a command only in the second program, - for one only in the
    first.
    """
    robot = comparison.second.robot
    if comparison.starts_elsewhere:
        parts = [
            f"{name} by {value:+.4g} {unit}"
            for name, value, unit in zip(
                robot.joint_names, comparison.start / robot.axis_units, robot.axis_unit_names, strict=True
            )
            if abs(value) > 1e-9
        ]
        yield "~", f"~ the second program starts elsewhere: {', '.join(parts)}"
    if comparison.holds_otherwise:
        yield from _watched_lines(comparison.first.watches, comparison.second.watches)
    shown = [command for command in comparison.commands if all_commands or command.status != "same"]
    titles = [_title(command) for command in shown]
    width = max((len(title) for title in titles), default=0)
    for title, command in zip(titles, shown, strict=True):
        sign = _SIGNS[command.status]
        yield sign, f"{sign} {title:{width}}  {difference_text(comparison, command)}"
    yield "", totals_text(comparison)


def _watched_lines(first: Sequence[Watch], second: Sequence[Watch]) -> Iterator[tuple[str, str]]:
    """Yield the differences between the inputs that two programs watch to hold the motions."""
    before, behind = ({(one.variable, one.value): one for one in watches} for watches in (first, second))
    yielded = False
    for key in dict.fromkeys((*before, *behind)):
        old, new = before.get(key), behind.get(key)
        if old == new:
            continue
        yielded = True
        one = new or old
        assert one is not None
        name = f"{one.name} ({one.variable}) is {state_text(one.value)}"
        if old is None or new is None:
            sign, word = ("+", "added") if old is None else ("-", "removed")
            yield sign, f"{sign} when {name}: {word}: {one.reaction}"
        elif old.then == new.then and old.name == new.name:
            yield "~", f"~ when {name}: {new.then} follows a different path"
        else:
            yield "~", f"~ when {name}: {old.name}: {old.reaction} -> {new.name}: {new.reaction}"
    if not yielded:
        yield "~", "~ the inputs that hold the motions are watched in a different order"


def _watched_json(watches: Sequence[Watch]) -> list[dict[str, object]]:
    return [
        {"input": one.name, "variable": one.variable, "value": one.value, "then": one.then, "way": one.way}
        for one in watches
    ]


def _title(command: Compared) -> str:
    second, first = command.second, command.first
    if first is None or second is None or first.title == second.title:
        act = second or first
        return act.title if act is not None else ""
    if first.name == second.name:
        return f"{second.title} (was {first.place})"
    return f"{second.title} (was {first.title})"


def difference_text(comparison: Comparison, command: Compared) -> str:
    """Return a description of a command's difference."""
    robot = comparison.second.robot
    match command.status, command.first, command.second:
        case "added", _, Act() as act:
            return f"added: {_act_text(act)}"
        case "removed", Act() as act, _:
            return f"removed: {_act_text(act)}"
        case "same", _, _:
            return "same"
        case _, Act() as first, Act() as second:
            parts: list[str] = []
            if command.differs and command.path is not None:
                parts.append(f"path differs by at most {path_text(robot, command.path)}")
            if command.other_branch and command.path is not None:
                joint = robot.joint_names[command.path.joint]
                unit = robot.axis_unit_names[command.path.joint]
                parts.append(
                    f"ends in another configuration: {joint} by up to {command.path.joint_off:.4g} {unit}"
                )
            if command.what:
                parts.append(f"{first.what} -> {second.what}")
            elif command.longer:
                parts.append(f"{first.duration:.3f} s -> {second.duration:.3f} s ({command.longer:+.3f} s)")
            if command.carries:
                parts.append(f"carries {_carried(first)} -> {_carried(second)}")
            if command.touches:
                parts.append(f"may touch: {_touching(first)} -> {_touching(second)}")
            if command.keeps:
                parts.append(
                    f"keeps to: {', '.join(first.keeps) or 'nothing'} -> "
                    f"{', '.join(second.keeps) or 'nothing'}"
                )
            return "; ".join(parts)
        case _:
            return ""


def _carried(act: Act) -> str:
    return ", ".join(act.carries or ()) or "nothing"


def _touching(act: Act) -> str:
    return ", ".join(act.may_touch) or "nothing"


def path_text(robot: Robot, path: PathDifference) -> str:
    """Return the difference of two paths in words, such as
    `5.02 mm, 0.1 deg (J3 by 1.2 deg), most at 63 % of the way`.
    """
    joint = f"{robot.joint_names[path.joint]} by {path.joint_off:.4g} {robot.axis_unit_names[path.joint]}"
    return (
        f"{path.position / MM:.4g} mm, {path.angle / DEG:.3g} deg ({joint}), most at {path.at * 100:.0f} % "
        "of the way"
    )


def _act_text(act: Act) -> str:
    return f"a motion of {act.duration:.3f} s" if act.curve is not None else act.what


def totals_text(comparison: Comparison) -> str:
    """Return the number of equal commands, and the durations of both programs."""
    counts = ", ".join(
        f"{comparison.count(status)} {status}"
        for status in ("same", "changed", "added", "removed")
        if status == "same" or comparison.count(status)
    )
    longer = comparison.second.duration - comparison.first.duration
    times = f"{comparison.first.lasting.text()} -> {comparison.second.lasting.text()} ({longer:+.3f} s)"
    tolerance = comparison.tolerance
    allowed = (
        f"tolerance {tolerance.position / MM:g} mm, {tolerance.angle / DEG:.4g} deg at {{{comparison.frame}}}"
    )
    return f"{counts}; {times}; {allowed}"


def compared_json(comparison: Comparison) -> dict[str, Any]:
    """Return a comparison of two programs as plain data, with units in the names. A missing command is
    null.
    """
    robot = comparison.second.robot
    return {
        "version": 1,
        "equal": comparison.equal,
        "first": _program(comparison.first),
        "second": _program(comparison.second),
        "tolerance": {
            "position_mm": comparison.tolerance.position / MM,
            "angle_deg": comparison.tolerance.angle / DEG,
            "frame": comparison.frame,
        },
        "held_by": [_watched_json(one.watches) for one in (comparison.first, comparison.second)],
        "start_differs": {
            f"{name}_{unit}": float(np.round(value, 9))
            for name, value, unit in zip(
                robot.joint_names, comparison.start / robot.axis_units, robot.axis_unit_names, strict=True
            )
        },
        "totals": {status: comparison.count(status) for status in ("same", "changed", "added", "removed")},
        "commands": [_pair(comparison, one) for one in comparison.commands],
    }


def _program(executed: Executed) -> dict[str, Any]:
    return {
        "file": executed.name,
        "robot": executed.robot.name,
        **executed.lasting.to_json(),
        "commands": len(executed.acts),
    }


def _pair(comparison: Comparison, one: Compared) -> dict[str, Any]:
    path, robot = one.path, comparison.second.robot
    return {
        "status": one.status,
        "first": _act(one.first),
        "second": _act(one.second),
        "path": None
        if path is None
        else {
            "position_mm": path.position / MM,
            "angle_deg": path.angle / DEG,
            "joint": robot.joint_names[path.joint],
            f"joint_off_{robot.axis_unit_names[path.joint]}": path.joint_off,
            "at_share_of_way": path.at,
            "differs": one.differs,
        },
        "other_configuration": one.other_branch,
        "longer_s": one.longer,
        "other_parts": one.carries,
        "text": difference_text(comparison, one),
    }


def _act(act: Act | None) -> dict[str, Any] | None:
    if act is None:
        return None
    return {
        "place": act.place,
        "name": act.name,
        "line": act.source_line,
        "kind": act.kind,
        "what": act.what or None,
        "duration_s": act.duration,
        "carries": None if act.carries is None else list(act.carries),
        **({"may_touch": list(act.may_touch)} if act.may_touch else {}),
        **({"keeps": list(act.keeps)} if act.keeps else {}),
    }
