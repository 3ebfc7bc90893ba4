"""Analogue signals: groups of bits whose number counts steps of a physical value. What is known when compiled is converted exactly; the runtime and the judge see integers alone."""

from __future__ import annotations

from fractions import Fraction

from yarclang.semantics.values.amounts import AmountError

_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


def mirrored(operator: str) -> str:
    """Return the comparison that says the same with its sides exchanged."""
    return _MIRRORED.get(operator, operator)


def steps_of(number: float, step: float, name: str) -> float:
    """Return how many steps a value is.

    Raises:
        AmountError: it lies between two steps; the message names both.
    """
    steps = _ratio(number, step)
    if steps.denominator == 1:
        return float(steps)
    below = steps.numerator // steps.denominator
    nearest = " and ".join(f"{float(count * _exact(step)):.10g}" for count in (below, below + 1))
    message = f"{name} goes in steps of {step:.10g}, and is never {number:.10g}"
    raise AmountError("Y0472", message, f"the nearest are {nearest}")


def compared(operator: str, number: float, step: float, name: str) -> tuple[str, float]:
    """Return a comparison of the number of steps that holds for the same readings as one of the value.

    Raises:
        AmountError: = and <> with a value between two steps.
    """
    steps = _ratio(number, step)
    if operator in ("<", ">="):
        return operator, float(-(-steps.numerator // steps.denominator))
    if operator in ("<=", ">"):
        return operator, float(steps.numerator // steps.denominator)
    return operator, steps_of(number, step, name)


def _exact(number: float) -> Fraction:
    """Return the number as it was written: 0.1 is a tenth."""
    return Fraction(repr(number))


def _ratio(number: float, step: float) -> Fraction:
    return _exact(number) / _exact(step)
