"""Read ROBOT, DEFAULT and START: declarations that apply to the whole file."""

from __future__ import annotations

from yarclang.diagnostics import Collector
from yarclang.hir import Array
from yarclang.robot.model import Robot
from yarclang.semantics.context import Defaults
from yarclang.semantics.declared.meanings import joint_values
from yarclang.semantics.motions.times import time_is_sound
from yarclang.semantics.names.frames import known_frame, moving_frame
from yarclang.semantics.names.scope import JointPosition, Scope
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.values.poses import check_limits
from yarclang.semantics.values.units import resolve_units
from yarclang.source import Span
from yarclang.subjects import unknown
from yarclang.syntax.ast import Module, Statement, Text, Word


def declared_robot(module: Module) -> tuple[str, Span] | None:
    """Return the robot that a ROBOT line names (a name or a path), and the place of this name. The line
    is read before everything else, since all checks need the robot.
    """
    for statement in module.statements:
        if statement.index is None and statement.name.name == "ROBOT" and len(statement.waypoints) == 1:
            values = statement.waypoints[0].values
            if len(values) == 1 and isinstance(values[0], Word | Text):
                return values[0].text.strip('"'), statement.span(values[0].place)
    return None


def check_robot(statement: Statement, findings: Collector) -> None:
    """Check that a ROBOT line has one name, or one path in quotes."""
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = [value for waypoint in statement.waypoints for value in waypoint.values]
    if len(values) != 1 or not isinstance(values[0], Word | Text):
        help_ = 'write ROBOT INDUSTRIAL6, or ROBOT "path/to/robot.toml"'
        findings.add(
            "Y0401", "ROBOT needs the robot's name, or a path in quotes", statement.whole_span, help_
        )


def read_default(statement: Statement, scope: Scope, findings: Collector) -> Defaults:
    """Read the values of a DEFAULT line, which apply to lines that lack them."""
    refuse_parts(statement, ("values", "options"), findings)
    units = resolve_units(statement, statement.units, findings)
    if statement.moving is not None:
        moving_frame(statement, statement.moving, scope, findings)
    if statement.base is not None:
        known_frame(statement, statement.base, scope, findings)
    time = statement.time
    if time is not None and not time_is_sound(statement, time, findings):
        time = None
    has_bad_time = statement.time is not None and time is None
    return Defaults(scope, statement, statement.moving, time, units or {}, statement.base, has_bad_time)


def read_start(
    statement: Statement, robot: Robot, scope: Scope, defaults: Defaults, findings: Collector
) -> Array | None:
    """Return the joint position (n,) [rad or m] of a START line; None with a finding if it is wrong.

    Args:
        statement: the line. It has joint values with units, or the name of a joint position.
        robot: the robot.
        scope: the names in scope at this line.
        defaults: the values of the DEFAULT line of its file.
        findings: receives the findings.
    """
    refuse_parts(statement, ("a moving frame", "a motion time", "a base frame", "options"), findings)
    values = tuple(value for waypoint in statement.waypoints for value in waypoint.values)
    if len(values) == 1 and isinstance(word := values[0], Word):
        found = scope.name(word.name)
        if isinstance(found, JointPosition):
            return found.q
        known = sorted(set(scope.names(JointPosition)))
        subject = unknown(word.text, known)
        help_ = subject.question or f"there are {', '.join(known)}"
        message = f"no joint position is named {word.text}"
        findings.add("Y0205", message, statement.span(word.place), help_, subject=subject)
        return None
    q = joint_values(statement, values, scope, defaults, robot, findings)
    if q is not None:
        check_limits(robot, q, findings, statement.whole_span)
    return q
