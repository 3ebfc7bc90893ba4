"""Evaluation of expressions: variables, operators, functions and comparisons (TSRM 23, PUM 233)."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Protocol

LARGEST = 2.0**100
"""Largest absolute value of a result. Larger values saturate (assumed; the controller's behaviour isn't
known).
"""


class Scope(Protocol):
    """All variables of the controller, as one coordinate system sees them."""

    def read(self, letter: str, index: int) -> float:
        """Return the value of a variable; `letter` is I, P, Q or M."""
        ...

    def write(self, letter: str, index: int, value: float) -> None:
        """Assign a value to a variable."""
        ...


Expression = Callable[[Scope], float]
Condition = Callable[[Scope], bool]
Data = float | Expression


def value_of(data: Data, scope: Scope) -> float:
    """Return the value of a constant or an expression."""
    return data(scope) if callable(data) else data


def bounded(value: float) -> float:
    """Limit a value to the range of the controller. NaN becomes 0 (assumed)."""
    if -LARGEST <= value <= LARGEST:
        return value
    if math.isnan(value):
        return 0.0
    return LARGEST if value > 0 else -LARGEST


def variable(letter: str, index: Data) -> Expression:
    """Return an expression for the value of a variable."""
    if callable(index):
        return lambda scope: scope.read(letter, int(index(scope)))
    number = int(index)
    return lambda scope: scope.read(letter, number)


def combined(function: Callable[[float, float], float], left: Expression, right: Expression) -> Expression:
    """Return an expression that applies a function to two expressions."""
    return lambda scope: bounded(function(left(scope), right(scope)))


def _quotient(left: float, right: float) -> float:
    """Divide. Division by zero saturates (assumed)."""
    if right == 0.0:
        return math.copysign(LARGEST, left) if left else 0.0
    return left / right


def _modulo(left: float, right: float) -> float:
    """Return the remainder of a division by n = `right`: from 0 to n for n > 0, from -|n| to |n| for n < 0
    (PUM 233).
    """
    if right == 0.0:
        return 0.0
    if right > 0.0:
        return left % right
    return (left - right) % (-2.0 * right) + right


def called(name: str, inner: Expression) -> Expression:
    """Return an expression that calls a function. Angles are in degrees if I15 is 0."""

    def evaluate(scope: Scope) -> float:
        unit = math.pi / 180.0 if scope.read("I", 15) == 0.0 else 1.0
        try:
            return bounded(_FUNCTIONS[name](inner(scope), unit, scope))
        except (ValueError, OverflowError, ZeroDivisionError):
            # An argument outside of a function's domain gives 0 (assumed).
            return 0.0

    return evaluate


SUMS: dict[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "|": lambda left, right: float(int(left) | int(right)),
    "^": lambda left, right: float(int(left) ^ int(right)),
}

PRODUCTS: dict[str, Callable[[float, float], float]] = {
    "*": operator.mul,
    "/": _quotient,
    "%": _modulo,
    "&": lambda left, right: float(int(left) & int(right)),
}

COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "=": operator.eq,
    "!=": operator.ne,
    ">": operator.gt,
    "!>": operator.le,
    "<": operator.lt,
    "!<": operator.ge,
    "~": lambda left, right: abs(left - right) < 0.5,
    "!~": lambda left, right: abs(left - right) >= 0.5,
}

_FUNCTIONS: dict[str, Callable[[float, float, Scope], float]] = {
    "SIN": lambda x, unit, _: math.sin(x * unit),
    "COS": lambda x, unit, _: math.cos(x * unit),
    "TAN": lambda x, unit, _: math.tan(x * unit),
    "ASIN": lambda x, unit, _: math.asin(x) / unit,
    "ACOS": lambda x, unit, _: math.acos(x) / unit,
    "ATAN": lambda x, unit, _: math.atan(x) / unit,
    "ATAN2": lambda x, unit, scope: math.atan2(x, scope.read("Q", 0)) / unit,
    "LN": lambda x, _, __: math.log(x),
    "EXP": lambda x, _, __: math.exp(x),
    "SQRT": lambda x, _, __: math.sqrt(x),
    "ABS": lambda x, _, __: abs(x),
    "INT": lambda x, _, __: float(math.floor(x)),
}
