"""Read the units of a statement, and numbers with units."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from yarclang.diagnostics import Collector
from yarclang.robot.model import Robot
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.values.amounts import Amount, no_unit
from yarclang.semantics.values.evaluate import LARGEST_NUMBER, EvaluationError, evaluate, quantity
from yarclang.syntax.ast import Computed, Number, Quantity, Statement, Units, Value
from yarclang.units import UNITS, Kind, Unit


def resolve_units(
    statement: Statement, units: Units | None, findings: Collector
) -> Mapping[Kind, Unit] | None:
    """Return the units that a statement names, by kind.

    Args:
        statement: the line.
        units: its units; None without any.
        findings: receives the finding.

    Returns:
        None with a finding if a unit is unknown, or if there are two of one kind.
    """
    found: dict[Kind, Unit] = {}
    if units is None:
        return found
    if not units.items:
        findings.add("Y0305", "the brackets have no unit", statement.span(units.place), "write (mm,deg,s)")
        return None
    for item in units.items:
        unit, span = UNITS.get(item.text.lower()), statement.span(item.place)
        if unit is None:
            findings.add_error(no_unit(item.text), span)
            return None
        if unit.kind in found:
            message = f"{found[unit.kind].name} and {unit.name} are both units of {unit.kind}"
            findings.add("Y0306", message, span, "remove one of them")
            return None
        found[unit.kind] = unit
    return found


@lru_cache(maxsize=8)
def joint_kinds(robot: Robot) -> tuple[Kind, ...]:
    """Return the kind of unit of each joint value of a robot."""
    return tuple("length" if unit == "mm" else "angle" for unit in robot.axis_unit_names)


def number_fault(item: Value) -> tuple[str, str, str] | None:
    """Return code, message and help of a finding if an item in a line isn't a valid number; None for a valid
    item.

    Valid items are expressions, and numbers up to LARGEST_NUMBER.
    """
    if isinstance(item, Number):
        if -LARGEST_NUMBER <= item.value <= LARGEST_NUMBER:
            return None
        return "Y0403", f"{item.text} is beyond the largest value, {LARGEST_NUMBER:,.0f}", ""
    if isinstance(item, Computed):
        return None
    text = item.text if len(item.text) <= 40 else item.text[:40] + "…"
    help_ = "numbers look like 30, -0.5, 1e-3; with blanks between them"
    if "," in item.text:
        help_ = "write a decimal point, and blanks between numbers"
    return "Y0402", f"`{text}` is not a number", help_


def amount(item: Value, scope: Scope, statement: Statement, findings: Collector) -> Amount | None:
    """Return the value of a number, an expression, or a number with a unit; None with a finding if it has
    an error.
    """
    try:
        match item:
            case Computed(expression=expression):
                found = evaluate(expression, scope)
                if abs(found.value) <= LARGEST_NUMBER:
                    return found
                message = f"{item.text} is {found}: beyond the largest value, {LARGEST_NUMBER:,.0f}"
                findings.add("Y0403", message, statement.span(item.place))
            case Quantity():
                return quantity(item)
            case Number(value=value):
                return Amount(value)
    except EvaluationError as error:
        findings.add_error(error, statement.span(error.place))
    return None
