"""ROBOT, DEFAULT and START: what holds for the whole file."""

from __future__ import annotations

import numpy as np

from yarclang.diagnostics import Collector, suggest
from yarclang.hir import Array
from yarclang.robot.model import Robot
from yarclang.semantics.context import Defaults
from yarclang.semantics.frames import check_frame, moving_frame
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.times import time_is_sound
from yarclang.semantics.units import missing_unit, number_fault, resolve_units
from yarclang.source import Span
from yarclang.syntax.ast import Module, Number, Statement, Text, Word
from yarclang.units import Kind


def declared_robot(module: Module) -> tuple[str, Span] | None:
    """The robot that a ROBOT line names (a name, or a path in quotes) and where, read before anything is checked."""
    for statement in module.statements:
        if statement.index is None and statement.name.name == "ROBOT" and len(statement.waypoints) == 1:
            values = statement.waypoints[0].values
            if len(values) == 1 and isinstance(values[0], Word | Text):
                return values[0].text.strip('"'), statement.span(values[0].place)
    return None


def check_robot(statement: Statement, findings: Collector) -> None:
    """A ROBOT line has one name, or one path in quotes."""
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = [value for waypoint in statement.waypoints for value in waypoint.values]
    if len(values) != 1 or not isinstance(values[0], Word | Text):
        help_ = 'write ROBOT INDUSTRIAL6, or ROBOT "path/to/robot.toml"'
        findings.add(
            "Y0401", "ROBOT takes the robot's name, or a path in quotes", statement.whole_span, help_
        )


def read_default(statement: Statement, robot: Robot, findings: Collector) -> Defaults:
    """The parts that a DEFAULT line gives."""
    refuse_parts(statement, ("values", "options"), findings)
    units = resolve_units(statement, statement.units, findings)
    if statement.moving is not None:
        moving_frame(statement, statement.moving, robot, findings)
    if statement.base is not None:
        check_frame(statement, statement.base, robot, findings)
    time = statement.time
    if time is not None and not time_is_sound(statement, time, findings):
        time = None
    has_bad_time = statement.time is not None and time is None
    return Defaults(statement, statement.moving, time, units or {}, statement.base, has_bad_time)


def read_start(statement: Statement, robot: Robot, defaults: Defaults, findings: Collector) -> Array | None:
    """The joint position (n,) [rad or m] of a START line: values with units, or a joint position's name."""
    refuse_parts(statement, ("a moving frame", "a motion time", "a base frame", "options"), findings)
    values = [value for waypoint in statement.waypoints for value in waypoint.values]
    if len(values) == 1 and isinstance(word := values[0], Word):
        if word.name in robot.positions:
            return robot.positions[word.name]
        help_ = suggest(word.text, robot.positions) or f"{robot.name} has {', '.join(robot.positions)}"
        message = f"no joint position is named {word.text}"
        findings.add("Y0205", message, statement.span(word.place), help_)
        return None
    units = resolve_units(statement, statement.units, findings)
    for value in values:
        fault = number_fault(value)
        if fault is not None:
            findings.add(fault[0], fault[1], statement.span(value.place), fault[2])
            return None
    if len(values) != robot.size:
        names = " ".join(robot.joint_names)
        message = f"START wants {robot.size} joint values ({names}), {len(values)} are given"
        findings.add("Y0401", message, statement.whole_span, "or the name of a joint position")
        return None
    if units is None:
        return None
    units = {**defaults.units, **units}
    kinds: list[Kind] = ["length" if name == "mm" else "angle" for name in robot.axis_unit_names]
    for kind in dict.fromkeys(kinds):
        if kind not in units:
            message, help_ = missing_unit(kind, "the joint values")
            findings.add("Y0304", message, statement.whole_span, help_)
            return None
    factors = [units[kind].factor for kind in kinds]
    return np.array([value.value for value in values if isinstance(value, Number)]) * factors
