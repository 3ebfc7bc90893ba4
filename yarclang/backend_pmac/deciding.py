"""Canonical form of expressions that are computed while a program runs, as used in the map of commands at the
top of a controller text.
"""

from __future__ import annotations

from yarclang.decisions import SIGNS, UNARY_SIGNS, Before, Between, Constant, InputValue, RegisterValue, Value


def canonical(value: Value) -> str:
    """Return the canonical text of a value: every nested operation is in brackets."""
    match value:
        case Constant(number=number):
            return f"{number:.9f}".rstrip("0").rstrip(".")
        case InputValue(variable=variable):
            return variable
        case RegisterValue(name=name):
            return f"${name}"
        case Before(operator=operator, inner=inner):
            return f"{UNARY_SIGNS[operator]}{_operand(inner)}"
        case Between(operator=operator, left=left, right=right):
            return f"{_operand(left)}{SIGNS[operator]}{_operand(right)}"


def _operand(value: Value) -> str:
    text = canonical(value)
    return f"({text})" if isinstance(value, Before | Between) else text
