"""Read a motion from a CSV table of joint positions or poses."""

from __future__ import annotations

import re

import numpy as np

from yarclang.convert.course import Content, Course, Wishes
from yarclang.convert.header import Column, Columns, understand
from yarclang.convert.names import legal_name
from yarclang.convert.table import Table, numbers_of, read_table
from yarclang.diagnostics import Collector
from yarclang.hir import Array
from yarclang.robot.model import Robot
from yarclang.source import SourceFile
from yarclang.units import UNITS

_QUATERNION_TOLERANCE = 1e-3


def content_of_table(source: SourceFile, robot: Robot, wishes: Wishes, findings: Collector) -> Content | None:
    """Return the motion in a table of targets; None, with a finding, if the table has mistakes.

    Args:
        source: the file.
        robot: the robot.
        wishes: the options.
        findings: collects findings.
    """
    table = read_table(source, findings)
    if table is None:
        return None
    columns = understand(table, robot, wishes.joints, wishes.units, findings)
    if columns is None:
        return None
    rated = [*columns.velocities, *columns.accelerations]
    numeric = [*columns.values, *rated, *([columns.time] if columns.time else [])]
    numbers = numbers_of(table, [column.number for column in numeric], findings)
    if numbers is None:
        return None
    values = numbers * np.array([_factor(column) for column in numeric])
    times: Array | None = None
    if columns.time is not None:
        values, times = values[:, :-1], values[:, -1]
        if not _rising(table, times, findings):
            return None
        times = times - times[0] if len(times) > 1 else times
    size = len(columns.values)
    velocities = values[:, size : 2 * size] if columns.velocities else None
    accelerations = values[:, 2 * size : 3 * size] if columns.accelerations else None
    values = values[:, :size]
    if columns.target == "QUAT" and not _are_rotations(table, values[:, 3:], findings):
        return None
    names = _names(table, columns, values, findings)
    if names is None:
        return None
    comments: tuple[str, ...] = ()
    if columns.comment is not None:
        comments = tuple(row[columns.comment.number] for row in table.rows)
    what, where = ("joint position", "") if columns.target == "JOINTS" else ("pose", " of {TCP} in {B}")
    kind = f"a table of {len(table.rows):,} {what}{'s' * (len(table.rows) > 1)}{where}"
    course = Course(columns.target, values, times, names, comments, (), velocities, accelerations)
    return Content(kind, (course,))


def _factor(column: Column) -> float:
    """Return the factor from a column's unit to mm, deg or s."""
    if column.unit is None:
        return 1.0
    ours = {"length": "mm", "angle": "deg", "time": "s"}[column.unit.kind]
    return 1.0 if column.unit.name == ours else column.unit.factor / UNITS[ours].factor


def _rising(table: Table, times: Array, findings: Collector) -> bool:
    """Return True if the times of the rows increase; report a finding if they don't."""
    steps = np.diff(times)
    if (steps > 0).all():
        return True
    row = int(np.argmax(steps <= 0)) + 1
    message = f"the time {times[row]:g} s isn't later than the one before, {times[row - 1]:g} s"
    findings.add(
        "Y1509",
        message,
        table.line_span(row),
        "make the times increase from row to row, or remove the column",
    )
    return False


def _are_rotations(table: Table, quaternions: Array, findings: Collector) -> bool:
    """Return True if all quaternions have norm 1; report a finding if they don't."""
    norms = np.linalg.norm(quaternions, axis=1)
    bad = np.abs(norms - 1.0) > _QUATERNION_TOLERANCE
    if not bad.any():
        return True
    row = int(np.argmax(bad))
    message = f"the quaternion qx qy qz qw has the norm {norms[row]:.6g}, not 1"
    findings.add("Y1505", message, table.line_span(row), "normalize it; qw is the real part")
    return False


def _names(table: Table, columns: Columns, values: Array, findings: Collector) -> tuple[str, ...] | None:
    """Return the targets' names in a table, converted to names that the language allows. Return None, with a
    finding, if that isn't possible.

    Rows with equal names must have equal values.
    """
    if columns.name is None:
        return ()
    names: list[str] = []
    first: dict[str, int] = {}
    for number, row in enumerate(table.rows):
        text = re.sub(r"[\s.-]+", "_", row[columns.name.number])
        if not text:
            names.append("")
            continue
        if refusal := legal_name(text, is_frame=columns.target != "JOINTS"):
            findings.add("Y1510", refusal, table.line_span(number), "choose another name in the table")
            return None
        name = text.upper()
        before = first.setdefault(name, number)
        if not np.array_equal(values[before], values[number]):
            message = f"{name} is already another position in line {table.lines[before]}"
            findings.add("Y1510", message, table.line_span(number), "give each position its own name")
            return None
        names.append(name)
    return tuple(names)
