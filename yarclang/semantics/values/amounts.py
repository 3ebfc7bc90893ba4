"""Numbers with or without a unit, and the operators and functions on them.

In sums and comparisons, a plain number gets the unit of the other operand. Values keep the unit in which
they were declared, so that a message shows the number that the user wrote.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from yarclang.diagnostics import FindingError
from yarclang.frozen import frozen
from yarclang.subjects import MissingUnit, unknown
from yarclang.units import UNITS, Kind, Unit, units_of


@frozen
class Amount:
    """A number, with its unit if it has one."""

    value: float
    unit: Unit | None = None

    def in_unit(self, unit: Unit) -> float:
        """Return the number in a unit; a plain number is assumed to be in that unit already.

        Raises:
            AmountError: the number has a unit of another kind.
        """
        if self.unit is None or self.unit is unit:
            return self.value
        if self.unit.kind != unit.kind:
            raise AmountError(
                "Y0307", f"{self} is {_a(self.unit.kind)}; {_a(unit.kind)} is needed here", "correct the unit"
            )
        return self.value * self.unit.factor / unit.factor

    def plain(self, what: str) -> float:
        """Return the number of an amount without a unit.

        Raises:
            AmountError: the amount has a unit. The message calls the number `what`.
        """
        if self.unit is not None:
            raise AmountError(
                "Y0307",
                f"{what} must be a plain number; {self} has a unit",
                "divide it by 1 in its unit, for example / 1 (mm)",
            )
        return self.value

    def __str__(self) -> str:
        return f"{self.value:.10g}" + (f" {self.unit.name}" if self.unit else "")


class AmountError(FindingError):
    """The error that a computation has no result."""


def no_unit(text: str) -> AmountError:
    """Return the error for a word that is no unit."""
    subject = unknown(text, UNITS)
    help_ = subject.question or f"units are {', '.join(UNITS)}"
    return AmountError("Y0305", f"`{text}` is no unit", help_, subject)


def missing_unit(kind: Kind, what: str) -> AmountError:
    """Return the error that a line lacks a unit for some of its values.

    Args:
        kind: kind of the unit.
        what: words for these values, with article.
    """
    names = " or ".join(units_of(kind)[:2])
    return AmountError(
        "Y0304",
        f"{what} need{'' if what.endswith('s') else 's'} a unit of {kind}",
        f"write one ({names}) in round brackets in the line, such as (mm,deg,s), or once in DEFAULT above it",
        MissingUnit(kind, what),
    )


def _a(kind: Kind) -> str:
    return {"length": "a length", "angle": "an angle", "time": "a time"}[kind]


def unary(operator: str, one: Amount) -> Amount:
    """Compute an operator with one operand."""
    match operator:
        case "-":
            return Amount(-one.value + 0.0, one.unit)
        case "NOT":
            return Amount(float(not one.value))
        case _:
            return one


def binary(operator: str, left: Amount, right: Amount) -> Amount:
    """Compute an operator with two operands.

    Raises:
        AmountError: the units of the operands don't go together, the divisor is zero, or the result isn't a
            finite number.
    """
    match operator:
        case "AND":
            return Amount(float(bool(left.value) and bool(right.value)))
        case "OR":
            return Amount(float(bool(left.value) or bool(right.value)))
        case "*" | "**":
            found = _product(operator, left, right)
        case "/" | "%":
            found = _quotient(operator, left, right)
        case "+" | "-":
            one, other, unit = _together(operator, left, right)
            found = Amount(one + other if operator == "+" else one - other, unit)
        case _:
            one, other, _ = _together(operator, left, right)
            return Amount(float(_COMPARED[operator](one, other)))
    if not math.isfinite(found.value):
        raise AmountError("Y0410", f"{left} {operator} {right} is too large to be computed")
    return found


_COMPARED: dict[str, Callable[[float, float], bool]] = {
    "=": lambda a, b: a == b,
    "<>": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
}


def _together(operator: str, left: Amount, right: Amount) -> tuple[float, float, Unit | None]:
    """Convert two numbers to a common unit: the unit of the left number, or else the unit of the right
    number. Return both numbers and the unit.

    Raises:
        AmountError: the units are of different kinds.
    """
    unit = left.unit or right.unit
    if unit is None:
        return left.value, right.value, None
    if left.unit and right.unit and left.unit.kind != right.unit.kind:
        what = f"{operator}({left}, {right})" if operator.isalnum() else f"{left} {operator} {right}"
        message = f"{what}: {_a(left.unit.kind)} and {_a(right.unit.kind)} can't be combined"
        raise AmountError("Y0307", message, "correct the units")
    return left.in_unit(unit), right.in_unit(unit), unit


def _product(operator: str, left: Amount, right: Amount) -> Amount:
    if operator == "**":
        if left.unit or right.unit:
            raise AmountError(
                "Y0307",
                f"{left} ** {right}: a power needs plain numbers",
                "divide by 1 in its unit, for example / 1 (mm)",
            )
        try:
            power = math.pow(left.value, right.value)
        except (OverflowError, ValueError):
            raise AmountError("Y0410", f"{left} ** {right} has no value, or is too large") from None
        return Amount(power)
    if left.unit and right.unit:
        message = f"{left} * {right}: the language has no unit for this product"
        raise AmountError("Y0307", message, "make one of the two a plain number")
    return Amount(left.value * right.value, left.unit or right.unit)


def _quotient(operator: str, left: Amount, right: Amount) -> Amount:
    if right.value == 0.0:
        raise AmountError("Y0410", f"{left} {operator} {right}: division by zero")
    if right.unit is None:
        value = left.value / right.value if operator == "/" else math.fmod(left.value, right.value)
        return Amount(value, left.unit)
    if left.unit is None:
        message = f"{left} {operator} {right}: a plain number can't be divided by {_a(right.unit.kind)}"
        raise AmountError("Y0307", message, "correct the units")
    one, other, unit = _together(operator, left, right)
    return Amount(one / other) if operator == "/" else Amount(math.fmod(one, other), unit)


def function(name: str, arguments: tuple[Amount, ...]) -> Amount:
    """Compute a function of the language. Plain numbers in SIN, COS and TAN are degrees; ATAN2 returns
    degrees.

    Raises:
        AmountError: the function doesn't accept the units, or has no value for these arguments.
    """
    first = arguments[0]
    match name:
        case "SIN" | "COS" | "TAN":
            angle = first.in_unit(UNITS["deg"]) if first.unit else first.value
            return Amount(_TRIGONOMETRY[name](math.radians(angle)))
        case "ATAN2":
            one, other, _ = _together(name, first, arguments[1])
            return Amount(math.degrees(math.atan2(one, other)), UNITS["deg"])
        case "SQRT":
            value = first.plain("the argument of SQRT")
            if value < 0.0:
                raise AmountError("Y0410", f"SQRT({first}): a negative number has no square root")
            return Amount(math.sqrt(value))
        case "MIN" | "MAX":
            found = first
            for another in arguments[1:]:
                a, b, unit = _together(name, found, another)
                found = Amount(min(a, b) if name == "MIN" else max(a, b), unit)
            return found
        case "ABS":
            return Amount(abs(first.value), first.unit)
        case "FLOOR":
            return Amount(float(math.floor(first.value)), first.unit)
        case _:
            return Amount(float(math.ceil(first.value)), first.unit)


_TRIGONOMETRY: dict[str, Callable[[float], float]] = {"SIN": math.sin, "COS": math.cos, "TAN": math.tan}
