"""Convert values of analogue signals. The bits of such a signal hold an integer, the number of steps. The
physical value is this number times the size of one step.

Values that are known at compile time are converted exactly; the runtime and the certificate see only
integers.
"""

from __future__ import annotations

from fractions import Fraction

from yarclang.semantics.values.amounts import AmountError

_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


def mirrored(operator: str) -> str:
    """Return the comparison operator that is equivalent after both sides are exchanged, such as > for <."""
    return _MIRRORED.get(operator, operator)


def steps_of(number: float, step: float, name: str) -> float:
    """Convert a physical value of an analogue signal to a number of steps.

    Args:
        number: the value.
        step: size of one step.
        name: name of the signal, for the error.

    Raises:
        AmountError: the value is between two steps; the help names both.
    """
    steps = _ratio(number, step)
    if steps.denominator == 1:
        return float(steps)
    below = steps.numerator // steps.denominator
    nearest = " and ".join(f"{float(count * _exact(step)):.10g}" for count in (below, below + 1))
    message = f"{name} has steps of {step:.10g}, and can't be {number:.10g}"
    raise AmountError("Y0472", message, f"the nearest possible values are {nearest}")


def compared(operator: str, number: float, step: float, name: str) -> tuple[str, float]:
    """Convert a comparison of an analogue input with a physical value to an equivalent comparison with a
    number of steps.

    Args:
        operator: the comparison.
        number: the value.
        step: size of one step.
        name: name of the signal, for the error.

    Raises:
        AmountError: the operator is = or <>, and the value is between two steps.
    """
    steps = _ratio(number, step)
    if operator in ("<", ">="):
        return operator, float(-(-steps.numerator // steps.denominator))
    if operator in ("<=", ">"):
        return operator, float(steps.numerator // steps.denominator)
    return operator, steps_of(number, step, name)


def _exact(number: float) -> Fraction:
    """Return a number as an exact fraction of its decimal text: 0.1 becomes 1/10."""
    return Fraction(repr(number))


def _ratio(number: float, step: float) -> Fraction:
    return _exact(number) / _exact(step)
