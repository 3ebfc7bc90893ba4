"""Find out what the columns of a table mean, from their names and units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from yarclang.convert.course import Target
from yarclang.convert.table import Table
from yarclang.diagnostics import Collector
from yarclang.robot.model import Robot
from yarclang.semantics.motions.trajectory_file import PER_SECOND, RATES, rate_of, split_unit, unit_of
from yarclang.units import Kind, Unit, units_of

_JOINT = re.compile(r"(?:j|q|joint)[ _]?([1-9][0-9]?)", re.I)
_PLACE = ("x", "y", "z")
_TURNS: Mapping[Target, tuple[str, ...]] = {
    "RPY": ("roll", "pitch", "yaw"),
    "QUAT": ("qx", "qy", "qz", "qw"),
}
_WORDS = {"time": "time", "t": "time", "time_from_start": "time", "name": "name", "comment": "comment"}


@dataclass(frozen=True, slots=True)
class Column:
    """A table's column with a known meaning.

    Attributes:
        number: index of the column.
        meaning: what the column contains: name of a joint or a coordinate, `J1_velocity`, `time` and so on.
        unit: unit of its numbers; None for a column without a unit.
    """

    number: int
    meaning: str
    unit: Unit | None


@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of a table, by their meanings.

    Attributes:
        target: kind of the targets in the rows: JOINTS, RPY or QUAT.
        values: columns of the target values, in their order.
        time: column of the time; None if there is no such column.
        name: column of the names; None if there is no such column.
        comment: column of the comments; None if there is no such column.
        velocities: columns of the joints' velocities; may be empty.
        accelerations: columns of the joints' accelerations; may be empty.
    """

    target: Target
    values: tuple[Column, ...]
    time: Column | None
    name: Column | None
    comment: Column | None
    velocities: tuple[Column, ...] = ()
    accelerations: tuple[Column, ...] = ()


def understand(
    table: Table, robot: Robot, joints: tuple[str, ...], units: Mapping[Kind, Unit], findings: Collector
) -> Columns | None:
    """Return the columns of a table by their meanings. Return None, with a finding, if columns or units are
    missing, or if two columns have the same meaning.

    Args:
        table: the table.
        robot: the robot. Columns may have the names of its joints, or j1, q1, joint1, joint_1 and so on.
        joints: the names that the robot's joints have in the table, in the robot's order; empty if the table
            uses the robot's names.
        units: units of columns whose names contain no unit.
        findings: collects findings, including a warning for columns that are ignored.
    """
    own = {name.lower(): name for name in robot.joint_names}
    own |= {other.lower(): name for other, name in zip(joints, robot.joint_names, strict=False)}
    found: dict[str, tuple[int, str]] = {}
    unknown: list[str] = []
    for number, cell in enumerate(table.header):
        name, unit = split_unit(cell)
        meaning = _meaning(name.strip(), robot, own)
        if not meaning:
            unknown += [cell] if cell else []
        elif meaning in found:
            _refuse(table, findings, f"two columns give {meaning}", found, unknown)
            return None
        else:
            found[meaning] = number, unit
    wanted = _target(table, robot, found, unknown, findings)
    if wanted is None:
        return None
    target, meanings = wanted
    rates = _rates(table, robot, target, found, unknown)
    columns: dict[str, Column] = {}
    lost: list[str] = []
    for meaning in (*meanings, *(one for order in rates for one in order), "time", "name", "comment"):
        if meaning not in found:
            continue
        number, text = found[meaning]
        base, order = rate_of(meaning)
        kind = _kind(base, target, robot)
        chosen: Unit | None = None
        if kind is not None:
            chosen = unit_of(text, kind, order) if text else units.get(kind)
            if text and chosen is None:
                per = PER_SECOND[order]
                message = f"column {table.header[number]!r}: {text} isn't a unit of {kind}{per and ' ' + per}"
                help_ = f"the units are {', '.join(one + per for one in units_of(kind))}"
                findings.add("Y1506", message, table.source.whole_line(table.header_line), help_)
                return None
            if chosen is None:
                lost.append(table.header[number])
                continue
        columns[meaning] = Column(number, meaning, chosen)
    if lost:
        message = (
            f"{'units' if len(lost) > 1 else 'the unit'} of {', '.join(lost)} "
            f"{'are' if len(lost) > 1 else 'is'} missing"
        )
        help_ = "write units into the header, as in `x [mm]` or `j1 (deg)`, or give --units mm,deg,s"
        findings.add("Y1506", message, table.source.whole_line(table.header_line), help_)
        return None
    if unknown:
        message = f"ignored: column{'s' * (len(unknown) > 1)} {', '.join(unknown)}"
        findings.add("Y1503", message, table.source.whole_line(table.header_line))
    return Columns(
        target,
        tuple(columns[meaning] for meaning in meanings),
        columns.get("time"),
        columns.get("name"),
        columns.get("comment"),
        *(tuple(columns[meaning] for meaning in order) for order in rates),
    )


def _rates(
    table: Table, robot: Robot, target: Target, found: dict[str, tuple[int, str]], unknown: list[str]
) -> tuple[tuple[str, ...], ...]:
    """Return the meanings of the velocity and acceleration columns that are used.

    Velocities are used if the table has a time and a velocity for each joint. Accelerations are used if
    velocities are used and there is an acceleration for each joint. Unused columns are added to `unknown`.
    """
    rates: list[tuple[str, ...]] = []
    for order in (1, 2):
        wanted = [f"{name}_{RATES[order]}" for name in robot.joint_names]
        given = [meaning for meaning in wanted if meaning in found]
        is_whole = len(given) == len(wanted) and target == "JOINTS" and "time" in found
        if is_whole and len(rates) == order - 1:
            rates.append(tuple(wanted))
        else:
            unknown += [table.header[found[meaning][0]] for meaning in given]
    return tuple(rates)


def _meaning(name: str, robot: Robot, own: Mapping[str, str]) -> str:
    """Return the meaning of a column: a joint, its velocity or acceleration, a coordinate of a pose, time,
    name or comment. The result is empty if the name isn't recognised.

    Args:
        name: name of the column.
        robot: the robot.
        own: names of the robot's joints, by the names that they have in the table, in lower case.
    """
    low = name.lower()
    if low in own:
        return own[low]
    base, order = rate_of(name)
    if order:
        joint = _meaning(base, robot, own)
        return f"{joint}_{RATES[order]}" if joint in robot.joint_names else ""
    numbered = _JOINT.fullmatch(name)
    if numbered and int(numbered[1]) <= robot.size:
        return robot.joint_names[int(numbered[1]) - 1]
    if low in _PLACE or any(low in turns for turns in _TURNS.values()):
        return low
    return _WORDS.get(low, "")


def _target(
    table: Table, robot: Robot, found: Mapping[str, object], unknown: list[str], findings: Collector
) -> tuple[Target, tuple[str, ...]] | None:
    """Return the kind of targets that the columns describe, and the meanings of the target values in order.
    Return None, with a finding, if the columns describe no target or different kinds of targets.
    """
    pose = [name for name in (*_PLACE, *_TURNS["RPY"], *_TURNS["QUAT"]) if name in found]
    joints = [name for name in robot.joint_names if name in found]
    if joints and pose:
        message = "there are both joint values and poses, but a target is one of them"
        _refuse(table, findings, message, found, unknown)
        return None
    if not joints and not pose:
        message = "the header names neither joints nor a pose"
        _refuse(table, findings, message, found, unknown)
        return None
    target: Target = "JOINTS"
    meanings = robot.joint_names
    if pose:
        target = "QUAT" if any(name in found for name in _TURNS["QUAT"]) else "RPY"
        meanings = (*_PLACE, *_TURNS[target])
        if surplus := [name for name in pose if name not in meanings]:
            message = f"the orientation is given twice: {', '.join(surplus)} besides a quaternion"
            _refuse(table, findings, message, found, unknown)
            return None
    if missing := [name for name in meanings if name not in found]:
        message = (
            f"column{'s' * (len(missing) > 1)} {', '.join(missing)} "
            f"{'are' if len(missing) > 1 else 'is'} missing"
        )
        _refuse(table, findings, message, found, unknown)
        return None
    return target, meanings


def _kind(meaning: str, target: Target, robot: Robot) -> Kind | None:
    """Return the kind of unit that a column has, such as a length or an angle; None if it has no unit."""
    if meaning in {"name", "comment"}:
        return None
    if meaning == "time":
        return "time"
    if target == "JOINTS":
        sliding = robot.chain.is_prismatic[robot.joint_names.index(meaning)]
        return "length" if sliding else "angle"
    if meaning in _PLACE:
        return "length"
    return "angle" if target == "RPY" else None


def _refuse(
    table: Table, findings: Collector, message: str, found: Mapping[str, object], unknown: list[str]
) -> None:
    """Report a finding about a table's header. It lists the recognised columns."""
    known = f"recognised: {', '.join(found)}" if found else "no column was recognised"
    strange = f"; not recognised: {', '.join(one[:40] for one in unknown[:8])}" if unknown else ""
    help_ = (
        "columns are j1 j2 ... or the robot's joint names; or x y z with roll pitch yaw or qx qy qz qw; "
        "and optionally time, j1_velocity ..., j1_acceleration ..., name, comment, separated by commas, "
        "semicolons or tabs"
    )
    span = table.source.whole_line(table.header_line)
    findings.add("Y1502", f"{message} ({known}{strange})", span, help_)
