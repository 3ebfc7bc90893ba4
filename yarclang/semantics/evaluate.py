"""Expressions to amounts."""

from __future__ import annotations

import math

from yarclang.diagnostics import suggest
from yarclang.semantics.amounts import Amount, AmountError, binary, function, unary
from yarclang.semantics.scope import KINDS, Scope
from yarclang.syntax.expressions import Binary, Bracket, Expression, Function, Name, Unary
from yarclang.syntax.leaves import Number, Place, Quantity
from yarclang.units import UNITS

LARGEST_NUMBER = 1e9


class EvaluationError(ValueError):
    """An expression without a value: where, the finding's code, its sentence, its help."""

    def __init__(self, place: Place, code: str, message: str, help_: str = "") -> None:
        super().__init__(message)
        self.place = place
        self.code = code
        self.message = message
        self.help = help_


def evaluate(expression: Expression, scope: Scope) -> Amount:
    """The value of an expression.

    Raises:
        EvaluationError: it has none.
    """
    match expression:
        case Number(text=text, value=value, place=place):
            if abs(value) > LARGEST_NUMBER:
                raise EvaluationError(
                    place, "Y0403", f"{text} is beyond the largest value, {LARGEST_NUMBER:,.0f}"
                )
            return Amount(value)
        case Quantity():
            return quantity(expression)
        case Name():
            return named(expression, scope)
        case Bracket(inner=inner):
            return evaluate(inner, scope)
        case Unary(operator=operator, operand=operand):
            return unary(operator, evaluate(operand, scope))
        case Binary(operator=operator, left=left, right=right, place=place):
            one, other = evaluate(left, scope), evaluate(right, scope)
            try:
                return binary(operator, one, other)
            except AmountError as error:
                raise EvaluationError(place, error.code, error.message, error.help) from None
        case Function(arguments=arguments, place=place):
            amounts = tuple(evaluate(argument, scope) for argument in arguments)
            try:
                return function(expression.name, amounts)
            except AmountError as error:
                raise EvaluationError(place, error.code, error.message, error.help) from None


def quantity(item: Quantity) -> Amount:
    """A number with its own unit.

    Raises:
        EvaluationError: it isn't a unit.
    """
    unit = UNITS.get(item.unit.text.lower())
    if unit is None:
        help_ = suggest(item.unit.text, UNITS) or f"units are {', '.join(UNITS)}"
        raise EvaluationError(item.unit.place, "Y0305", f"`{item.unit.text}` is no unit", help_)
    return Amount(item.number.value, unit)


def named(name: Name, scope: Scope) -> Amount:
    """The number that a name stands for.

    Raises:
        EvaluationError: it stands for none.
    """
    if name.name == "PI":
        return Amount(math.pi)
    found = scope.name(name.name)
    if isinstance(found, Amount):
        return found
    if found is not None:
        raise EvaluationError(name.place, "Y0209", f"{name.text} is {KINDS[type(found)]}, not a number")
    known = sorted(set(scope.names(Amount)))
    help_ = suggest(name.text, known) or (
        f"there are {', '.join(known[:8])}" if known else "declare it by LET"
    )
    raise EvaluationError(name.place, "Y0210", f"no number is named {name.text}", help_)
