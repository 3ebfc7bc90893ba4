"""Declare a FUNC: a name for an expression with parameters."""

from __future__ import annotations

from collections.abc import Hashable, Iterator

from yarclang.diagnostics import Collector
from yarclang.robot.model import Robot
from yarclang.semantics.declared.meanings import may_be_declared
from yarclang.semantics.files import values_of
from yarclang.semantics.names.scope import Formula, Scope, Where
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.values.amounts import Amount, no_unit
from yarclang.semantics.values.evaluate import EvaluationError, formula_of, named, quantity, table_of
from yarclang.syntax.ast import Number, Parameter, Quantity, Statement, Word
from yarclang.syntax.expressions import DEEPEST_EXPRESSION, Applied, Element, Expression, Name, parts_of
from yarclang.syntax.print import print_expression
from yarclang.units import UNITS, Unit

HEAVIEST = 1000
"""Largest number of operations in one use of a FUNC, including those of the functions that it uses."""


def declare_function(statement: Statement, scope: Scope, robot: Robot, findings: Collector) -> None:
    """Declare a function such as FUNC MID(A, B) = (A + B) / 2."""
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    word, *parameters = values_of(statement)
    body = statement.expression
    assert isinstance(word, Word)
    assert body is not None
    if not may_be_declared(statement, word, scope, robot, findings):
        return
    inner = Scope(scope)
    taken: list[tuple[str, Unit | None]] = []
    for parameter in parameters:
        assert isinstance(parameter, Parameter)
        where = Where(findings.source, statement.span(parameter.word.place))
        if may_be_declared(statement, parameter.word, inner, robot, findings, may_hide=True):
            inner.declare(parameter.word.name, Amount(1.0), where)
        unit: Unit | None = None
        if parameter.unit is not None and (unit := UNITS.get(parameter.unit.text.lower())) is None:
            findings.add_error(no_unit(parameter.unit.text), statement.span(parameter.unit.place))
        taken.append((parameter.word.name, unit))
    weight, depth = 1, 1
    used: tuple[Hashable, ...] = ()
    try:
        used = tuple(_used(body, inner, frozenset(name for name, _ in taken)))
        weight, depth = _size(body, scope)
    except EvaluationError as error:
        findings.add_error(error, statement.span(error.place))
        # The error is reported, but the name is declared below, so that its uses cause no further errors.
        body = Number("1", 1.0, body.place)
    if weight > HEAVIEST or depth > DEEPEST_EXPRESSION:
        most = f"{HEAVIEST:,} operations" if weight > HEAVIEST else f"{DEEPEST_EXPRESSION} nested operations"
        message = f"{word.text} and the functions in it have more than {most}"
        findings.add("Y0112", message, statement.whole_span, "compute parts of it with LET")
        body, weight, depth = Number("1", 1.0, body.place), 1, 1
    meaning = tuple(taken), print_expression(body), used
    where = Where(findings.source, statement.span(word.place))
    # All names in the expression are declared and never change their meaning: no copy of the scope is needed.
    scope.declare(word.name, Formula(tuple(taken), body, scope, weight, depth, meaning), where)


def _used(expression: Expression, scope: Scope, own: frozenset[str]) -> Iterator[Hashable]:
    """Yield the meanings of the names in a FUNC's expression, as values that can be compared.

    Args:
        expression: the expression.
        scope: the names in scope at this line.
        own: names of the function's own parameters, which are left out.

    Raises:
        EvaluationError: a name doesn't stand for a number or function, or a function is used with a wrong
            number of arguments.
    """
    match expression:
        case Name(name=name):
            if name not in own:
                found = named(expression, scope)
                yield name, repr(found.value), found.unit
            return
        case Element(table=table):
            rows = table_of(expression, scope).rows
            yield table.name, tuple(tuple((repr(one.value), one.unit) for one in row) for row in rows)
        case Applied(function=function):
            yield function.name, formula_of(expression, scope).meaning
        case Quantity():
            quantity(expression)
    for part in parts_of(expression):
        if not (isinstance(expression, Element | Applied) and part is parts_of(expression)[0]):
            yield from _used(part, scope, own)


def _size(expression: Expression, scope: Scope) -> tuple[int, int]:
    """Return the number of operations in an expression, and the depth to which they are nested."""
    sizes = [_size(part, scope) for part in parts_of(expression)]
    weight, depth = 1 + sum(one for one, _ in sizes), 1 + max((one for _, one in sizes), default=0)
    if isinstance(expression, Applied):
        formula = formula_of(expression, scope)
        return weight + formula.weight, depth + formula.depth
    return weight, depth
