"""Convert the values of a waypoint to SI: from mm and deg to m and rad."""

from __future__ import annotations

import numpy as np

from yarclang.commands.spec import Values
from yarclang.hir import Array
from yarclang.semantics.motions.line import WHAT, Line
from yarclang.semantics.names.scope import JointPosition, Pose
from yarclang.semantics.values.amounts import Amount, AmountError
from yarclang.semantics.values.units import amount, joint_kinds, number_fault
from yarclang.syntax.ast import Number, Value, WayPoint, Word
from yarclang.syntax.leaves import from_to
from yarclang.units import Kind, Unit


def numbers_of(line: Line, waypoint: WayPoint, number: int, values: Values) -> Array | None:
    """Return the values of a waypoint in SI; None with findings if they have errors.

    Args:
        line: the command.
        waypoint: the waypoint.
        number: its number, from 1.
        values: the kind of its values.
    """
    labels = values.labels(line.robot.joint_names)
    faults = 0
    for value in waypoint.values:
        fault = number_fault(value)
        if fault is not None:
            code, message, help_ = fault
            if isinstance(value, Word) and isinstance(line.scope.name(value.name), JointPosition):
                help_ = f"{value.name} is a joint position: write it alone after MOVEJ"
            elif isinstance(value, Word) and isinstance(line.scope.name(value.name), Pose):
                help_ = (
                    f"{value.name} is a pose: write its name as the whole waypoint, as in MOVEL {value.name}"
                )
            elif isinstance(value, Word) and isinstance(line.scope.name(value.name), Amount):
                help_ = f"write ${value.name} for its value"
            line.findings.add(code, message, line.statement.span(value.place), help_)
            faults += 1
    if faults:
        return None
    if len(waypoint.values) != len(labels):
        many = len(line.statement.waypoints) > 1
        which = f"waypoint {number} of {line.name.spec.name}" if many else line.name.full
        given = len(waypoint.values)
        difference = len(labels) - given
        help_ = (
            f"{difference} missing: {' '.join(labels[given:])}"
            if difference > 0
            else _surplus(waypoint.values[len(labels) :])
        )
        verb = "is" if given == 1 else "are"
        message = f"{which} takes {len(labels)} values ({' '.join(labels)}), {given} {verb} given"
        surplus = waypoint.values[len(labels) :]
        place = from_to(surplus[0].place, surplus[-1].place) if surplus else waypoint.place
        line.findings.add("Y0401", message, line.statement.span(place), help_)
        return None
    if line.units is None:
        return None
    return _in_si(line, waypoint, values.kinds(joint_kinds(line.robot)))


def _surplus(values: tuple[Value, ...]) -> str:
    """Return the help text about surplus values: those after the last value that a waypoint takes."""
    if len(values) > 1:
        return f"remove the last {len(values)}"
    text = values[0].text
    return f"remove {text}, or write [{text}] if it is the motion time"


def _in_si(line: Line, waypoint: WayPoint, kinds: tuple[Kind | None, ...]) -> Array | None:
    """Convert numbers to SI; None with findings if they have errors. A missing unit of a kind is reported
    once in a line.
    """
    numbers: list[float] = []
    complete = True
    units = line.units or {}
    for value, kind in zip(waypoint.values, kinds, strict=True):
        unit = None if kind is None else units.get(kind)
        if isinstance(value, Number):
            if kind is None:
                numbers.append(value.value)
            elif unit is not None:
                numbers.append(value.value * unit.factor)
            else:
                line.missing(kind, line.statement.span(line.statement.waypoints[0].place))
                complete = False
            continue
        found = _computed(line, value, kind, unit)
        if found is None:
            complete = False
        else:
            numbers.append(found)
    return np.array(numbers) if complete else None


def _computed(line: Line, value: Value, kind: Kind | None, unit: Unit | None) -> float | None:
    """Return the value of an expression in SI; None with a finding if it has none.

    Args:
        line: the command.
        value: the expression.
        kind: the kind of unit that it needs; None for a plain number.
        unit: the line's unit of this kind; None without one.
    """
    found = amount(value, line.scope, line.statement, line.findings)
    if found is None:
        return None
    span = line.statement.span(value.place)
    try:
        if kind is None:
            return found.plain("a part of a quaternion")
        if unit is not None:
            return found.in_unit(unit) * unit.factor
        if found.unit is not None:
            if found.unit.kind != kind:
                raise AmountError("Y0307", f"{found} is of the wrong kind: this value must be {WHAT[kind]}")
            return found.value * found.unit.factor
    except AmountError as error:
        line.findings.add_error(error, span)
        return None
    line.missing(kind, span)
    return None
