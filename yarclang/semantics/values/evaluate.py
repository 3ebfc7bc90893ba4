"""Evaluate expressions at compile time."""

from __future__ import annotations

import math

from yarclang.decisions import Register
from yarclang.diagnostics import FindingError
from yarclang.semantics.names.scope import KINDS, Formula, Input, JointPosition, Places, Pose, Scope, Table
from yarclang.semantics.values.amounts import Amount, AmountError, binary, function, no_unit, unary
from yarclang.subjects import Subject, unknown
from yarclang.syntax.expressions import Applied, Binary, Bracket, Element, Expression, Function, Name, Unary
from yarclang.syntax.leaves import Number, Place, Quantity
from yarclang.syntax.words import FUNCTIONS
from yarclang.units import UNITS

LARGEST_NUMBER = 1e9

AT_RUN_TIME = "its value is known only when the program runs: use it in WHEN, CASE or SET"
"""Help text of the finding that an expression for compile time uses a register or an input."""


class EvaluationError(FindingError):
    """The error that an expression has no value.

    Attributes:
        place: place of the error in the statement.
    """

    def __init__(
        self, place: Place, code: str, message: str, help_: str = "", subject: Subject | None = None
    ) -> None:
        super().__init__(code, message, help_, subject)
        self.place = place

    @classmethod
    def at(cls, place: Place, error: AmountError) -> EvaluationError:
        """Return the error of a computation, with a place."""
        return cls(place, error.code, error.message, error.help, error.subject)


def evaluate(expression: Expression, scope: Scope) -> Amount:
    """Return the value of an expression.

    Raises:
        EvaluationError: the expression has no value.
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
        case Element():
            return _element(expression, scope)
        case Applied():
            return _applied(expression, scope)
        case Bracket(inner=inner):
            return evaluate(inner, scope)
        case Unary(operator=operator, operand=operand):
            return unary(operator, evaluate(operand, scope))
        case Binary(operator=operator, left=left, right=right, place=place):
            one, other = evaluate(left, scope), evaluate(right, scope)
            try:
                return binary(operator, one, other)
            except AmountError as error:
                raise EvaluationError.at(place, error) from None
        case Function(arguments=arguments, place=place):
            amounts = tuple(evaluate(argument, scope) for argument in arguments)
            try:
                return function(expression.name, amounts)
            except AmountError as error:
                raise EvaluationError.at(place, error) from None


def quantity(item: Quantity) -> Amount:
    """Return a number with its own unit.

    Raises:
        EvaluationError: there is no such unit.
    """
    unit = UNITS.get(item.unit.text.lower())
    if unit is None:
        raise EvaluationError.at(item.unit.place, no_unit(item.unit.text))
    return Amount(item.number.value, unit)


def named(name: Name, scope: Scope) -> Amount:
    """Return the number that a name stands for.

    Raises:
        EvaluationError: the name is unknown, or doesn't stand for a number.
    """
    if name.name == "PI":
        return Amount(math.pi)
    found = scope.name(name.name)
    if isinstance(found, Amount):
        return found
    if found is not None:
        help_ = AT_RUN_TIME if isinstance(found, Register | Input) else ""
        if isinstance(found, Table):
            first = f"{name.text}[{', '.join('0' * len(found.sizes))}]"
            help_ = f"{first} is its first number; outside of expressions write $({first})"
        if isinstance(found, Formula):
            help_ = f"write {name.text}({', '.join(one for one, _ in found.parameters)})"
        raise EvaluationError(
            name.place, "Y0209", f"{name.text} is {KINDS[type(found)]}, not a number", help_
        )
    known = sorted(set(scope.names(Amount)))
    subject = unknown(name.text, known)
    help_ = subject.question or (f"there are {', '.join(known[:8])}" if known else "declare it by LET")
    raise EvaluationError(name.place, "Y0210", f"no number is named {name.text}", help_, subject)


def table_of(element: Element, scope: Scope) -> Table:
    """Return the table to which an element such as `T[2]` belongs.

    Raises:
        EvaluationError: there is no such table, or the number of indices is wrong.
    """
    name, found = element.table, scope.name(element.table.name)
    if isinstance(found, Places):
        message = f"{name.text} is a table of poses or joint positions, not of numbers"
        help_ = f"write $({name.text}[0]) as the whole waypoint"
        raise EvaluationError(name.place, "Y0209", message, help_)
    if not isinstance(found, Table):
        known = sorted(set(scope.names(Table)))
        if found is not None:
            message = f"{name.text} is {KINDS[type(found)]}, not a table"
            raise EvaluationError(name.place, "Y0209", message, "remove the index: only tables have one")
        subject = unknown(name.text, known)
        help_ = subject.question or (f"there are {', '.join(known[:8])}" if known else "declare it by TABLE")
        raise EvaluationError(name.place, "Y0210", f"no table is named {name.text}", help_, subject)
    _check_indices(element, found.sizes)
    return found


def _check_indices(element: Element, sizes: tuple[int, ...]) -> None:
    name, given = element.table, len(element.indices)
    if given != len(sizes):
        wanted, example = ("one index", "I") if len(sizes) == 1 else ("two indices", "I, J")
        message = f"{name.text} takes {wanted}, {given} {'is' if given == 1 else 'are'} given"
        raise EvaluationError(element.place, "Y0457", message, f"write {name.text}[{example}]")


def is_place(expression: Expression, scope: Scope) -> bool:
    """Return True if an expression is an element of a table of places (poses or joint positions), even with a
    wrong index.
    """
    return isinstance(expression, Element) and isinstance(scope.name(expression.table.name), Places)


def place_named(expression: Expression, scope: Scope) -> Pose | JointPosition | None:
    """Return the pose or joint position of a table to which an expression such as `SPOTS[2]` refers; None for
    any other expression.

    Raises:
        EvaluationError: the table has no such element.
    """
    if not isinstance(expression, Element) or not isinstance(
        found := scope.name(expression.table.name), Places
    ):
        return None
    _check_indices(expression, found.sizes)
    (index,) = expression.indices
    return found.rows[_index(index, evaluate(index, scope), len(found.rows), expression.table, "place")]


def _element(element: Element, scope: Scope) -> Amount:
    """Return the number of a table to which an expression such as `T[2]` refers.

    Raises:
        EvaluationError: there is no such table or element.
    """
    name, found = element.table, table_of(element, scope)
    sizes = found.sizes
    counted = ("value",) if len(sizes) == 1 else ("row", "column")
    whole = tuple(
        _index(index, evaluate(index, scope), size, name, what)
        for index, size, what in zip(element.indices, sizes, counted, strict=True)
    )
    return found.at(whole)


def formula_of(applied: Applied, scope: Scope) -> Formula:
    """Return the FUNC that an expression calls.

    Raises:
        EvaluationError: there is no such function, or the number of arguments is wrong.
    """
    name, found, given = applied.function, scope.name(applied.function.name), len(applied.arguments)
    if not isinstance(found, Formula):
        if all(isinstance(one, Name) and one.text.lower() in UNITS for one in applied.arguments):
            message = f"`{name.text}` can't be followed by a unit: it has the unit of its declaration"
            help_ = "remove the bracket, or write a number: 60 (mm)"
            raise EvaluationError(name.place, "Y0109", message, help_)
        subject = unknown(name.text, [*FUNCTIONS, *sorted(set(scope.names(Formula)))])
        is_ = "" if found is None else f": {name.text} is {KINDS[type(found)]}"
        help_ = (
            subject.question
            or f"the functions are {' '.join(FUNCTIONS)}, and those declared by FUNC above this line"
        )
        raise EvaluationError(name.place, "Y0109", f"no function is named {name.text}{is_}", help_, subject)
    if given != (wanted := len(found.parameters)):
        message = (
            f"{name.text} takes {wanted} argument{'s' * (wanted > 1)}, {given} "
            f"{'is' if given == 1 else 'are'} given"
        )
        help_ = f"write {name.text}({', '.join(one for one, _ in found.parameters)})"
        raise EvaluationError(applied.place, "Y0110", message, help_)
    return found


def _applied(applied: Applied, scope: Scope) -> Amount:
    formula = formula_of(applied, scope)
    inner = Scope(formula.scope)
    for (name, unit), argument in zip(formula.parameters, applied.arguments, strict=True):
        value = evaluate(argument, scope)
        try:
            inner.declare(name, value if unit is None else Amount(value.in_unit(unit), unit))
        except AmountError as error:
            message = f"{name} of {applied.function.text}: {error.message}"
            raise EvaluationError(argument.place, error.code, message, error.help) from None
    try:
        return evaluate(formula.body, inner)
    except EvaluationError as error:
        # The place of the error is in the line of FUNC, and would be wrong in the statement.
        message = f"in {applied.function.text}: {error.message}"
        raise EvaluationError(applied.place, error.code, message, error.help, error.subject) from None


def _index(index: Expression, amount: Amount, size: int, name: Name, what: str) -> int:
    try:
        value = amount.plain("an index")
    except AmountError as error:
        raise EvaluationError.at(index.place, error) from None
    near = round(value)
    # 0.3/0.1 is 2.9999999999999996: tolerate rounding errors.
    if abs(value - near) > _ROUNDING:
        message = f"the index of {name.text} is {value:.10g}, and an index must be an integer"
        raise EvaluationError(index.place, "Y0457", message, "round it down by FLOOR(...)")
    if not 0 <= near < size:
        count = f"{size} {what}{'s' * (size > 1)}"
        message = f"{name.text} has no {what} {near}: it has {count}, and indices begin with 0"
        help_ = f"use an index from 0 to {size - 1}" if size > 1 else "the only index is 0"
        raise EvaluationError(index.place, "Y0456", message, help_)
    return near


_ROUNDING = 1e-9
