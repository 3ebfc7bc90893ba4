"""Read expressions of registers, inputs and numbers whose value is known only at run time."""

from __future__ import annotations

from typing import NoReturn

from yarclang.decisions import (
    ARITHMETIC,
    COMPARISONS,
    CONNECTIVES,
    DECIMALS,
    DEEPEST,
    LARGEST,
    MOST_LEAVES,
    Before,
    Between,
    Constant,
    InputValue,
    Register,
    RegisterValue,
    Value,
    is_condition,
    is_printed,
    leaves,
)
from yarclang.semantics.names.scope import KINDS, Input, Scope
from yarclang.semantics.values.amounts import Amount, AmountError
from yarclang.semantics.values.evaluate import EvaluationError, evaluate
from yarclang.semantics.values.steps import compared, mirrored
from yarclang.subjects import unknown
from yarclang.syntax.expressions import (
    Applied,
    Binary,
    Bracket,
    Element,
    Expression,
    Function,
    Name,
    Unary,
    parts_of,
)

_EXAMPLE = "write a comparison: N = 1, DOOR = ON"
_STATES = {"ON": 1.0, "OFF": 0.0}


def condition_of(expression: Expression, scope: Scope) -> Value:
    """Convert an expression to a condition that is decided at run time.

    Raises:
        EvaluationError: the expression is wrong, is a number, or never changes at run time.
    """
    value = _value(expression, scope)
    if all(isinstance(one, Constant) for one in leaves(value)):
        message = "this condition has no register or input: it can't change while the program runs"
        raise EvaluationError(
            expression.place, "Y0430", message, "use IF, which is decided when the program is compiled"
        )
    if not is_condition(value):
        raise EvaluationError(
            expression.place, "Y0430", "this is a number, and a condition is needed", _EXAMPLE
        )
    return value


def number_of(expression: Expression, scope: Scope) -> Value:
    """Convert an expression to a number that is computed at run time.

    Raises:
        EvaluationError: the expression is wrong, or is a condition.
    """
    value = _value(expression, scope)
    if is_condition(value):
        help_ = "use WHEN for a condition; SET needs a number"
        raise EvaluationError(expression.place, "Y0430", "this is a condition, and a number is needed", help_)
    return value


def _value(expression: Expression, scope: Scope) -> Value:
    value = _part(expression, scope, 0)
    if sum(1 for _ in leaves(value)) > MOST_LEAVES:
        message = f"an expression may have at most {MOST_LEAVES} registers, inputs and numbers"
        raise EvaluationError(expression.place, "Y0430", message, "compute it in several steps by SET")
    return value


def _part(expression: Expression, scope: Scope, depth: int) -> Value:
    """Convert a subexpression to a value that is computed at run time. Constant subexpressions are computed
    now.

    Args:
        expression: the subexpression.
        scope: the names in scope at this line.
        depth: number of operations around the subexpression.
    """
    if depth > DEEPEST:
        message = f"an expression may have at most {DEEPEST} nested operations"
        raise EvaluationError(expression.place, "Y0430", message, "compute it in several steps by SET")
    if not isinstance(expression, Name) and not _decides(expression, scope):
        return _known(expression, scope)
    match expression:
        case Name():
            return _named(expression, scope)
        case Bracket(inner=inner):
            return _part(inner, scope, depth)
        case Unary(operator=operator, operand=operand):
            inner_value = _part(operand, scope, depth + 1)
            if operator == "+":
                return inner_value
            _check(inner_value, operand, wants_condition=operator == "NOT")
            if operator == "-" and isinstance(inner_value, Constant):
                return Constant(0.0 - inner_value.number)
            return Before(operator, inner_value)
        case Function(arguments=(Binary(operator="/") as quotient,)) if expression.name == "FLOOR":
            return _between("DIV", quotient, scope, depth)
        case Binary(operator=operator):
            if operator in ("/", "**"):
                _refuse(expression, f"{operator} can't be computed while the program runs")
            return _between("MOD" if operator == "%" else operator, expression, scope, depth)
        case Element():
            message = f"the index of {expression.table.text} must be known when compiled"
            raise EvaluationError(
                expression.place, "Y0430", message, "to choose when the program runs, use CASE"
            )
        case Applied(function=function):
            _refuse(expression, f"{function.text} can't be computed while the program runs")
        case Function():
            _refuse(expression, f"{expression.name} can't be computed while the program runs")
    raise AssertionError(expression)  # numbers are handled by `_known` above


def _refuse(expression: Expression, message: str) -> NoReturn:
    help_ = "use + - * %, FLOOR(a / b), comparisons, AND, OR and NOT"
    raise EvaluationError(expression.place, "Y0430", message, help_)


def _between(operator: str, expression: Binary, scope: Scope, depth: int) -> Value:
    if (found := _in_steps(operator, expression, scope)) is not None:
        return found
    left, right = (_part(one, scope, depth + 1) for one in (expression.left, expression.right))
    for value, said in ((left, expression.left), (right, expression.right)):
        _check(value, said, wants_condition=operator in CONNECTIVES)
        if operator in ARITHMETIC and isinstance(value, Constant) and not value.number.is_integer():
            _refuse(said, f"{value.number:.15g} isn't an integer")
    return Between(operator, left, right)


def _in_steps(operator: str, expression: Binary, scope: Scope) -> Value | None:
    """Convert a comparison of an analogue input, with a number or with another input of equal step size, to a
    comparison of integers (numbers of steps).

    Returns:
        None without an analogue input on either side, or if the operator is no comparison.
    """
    left, right = _analogue(expression.left, scope), _analogue(expression.right, scope)
    if operator not in COMPARISONS or (left is None and right is None):
        return None
    if left is not None and right is not None:
        if left.step != right.step:
            message = "two analogue inputs with different steps can't be compared"
            raise EvaluationError(expression.place, "Y0472", message, "compare each of them with a number")
        return Between(operator, _read(left), _read(right))
    analogue, number, said = (
        (left, expression.right, operator)
        if left is not None
        else (right, expression.left, mirrored(operator))
    )
    assert analogue is not None
    assert analogue.step is not None
    if _decides(number, scope):
        message = (
            f"{analogue.signal.name} is analogue: it can be compared only with a number that is known when "
            "compiled"
        )
        raise EvaluationError(expression.place, "Y0472", message, _ANALOGUE)
    try:
        said, steps = compared(said, _known(number, scope).number, analogue.step, analogue.signal.name)
    except AmountError as error:
        raise EvaluationError.at(number.place, error) from None
    return Between(said, _read(analogue), Constant(steps))


def _read(found: Input) -> InputValue:
    return InputValue(found.signal.variable, found.signal.name)


_ANALOGUE = "write a comparison such as PRESSURE > 4.5; a register can't hold an analogue value"


def _analogue(expression: Expression, scope: Scope) -> Input | None:
    """Return the analogue input that one side of a comparison names; None if this side names none."""
    while isinstance(expression, Bracket):
        expression = expression.inner
    found = scope.name(expression.name) if isinstance(expression, Name) else None
    return found if isinstance(found, Input) and found.step is not None else None


def _check(value: Value, expression: Expression, *, wants_condition: bool) -> None:
    is_known = isinstance(value, Constant) and value.number in (0.0, 1.0)
    if wants_condition and not is_condition(value) and not is_known:
        raise EvaluationError(
            expression.place, "Y0430", "this is a number, and a condition is needed", _EXAMPLE
        )
    if not wants_condition and is_condition(value):
        raise EvaluationError(
            expression.place, "Y0430", "this is a condition, and a number is needed", "remove the brackets"
        )


def _decides(expression: Expression, scope: Scope) -> bool:
    """Return True if an expression contains ON, OFF, or a name that doesn't stand for a number at compile
    time.
    """
    if isinstance(expression, Name):
        return expression.name in _STATES or not isinstance(scope.name(expression.name), Amount)
    if isinstance(expression, Applied):
        return any(_decides(one, scope) for one in expression.arguments)
    if isinstance(expression, Element):
        return any(_decides(one, scope) for one in expression.indices)
    return any(_decides(one, scope) for one in parts_of(expression))


def _named(name: Name, scope: Scope) -> Value:
    if name.name in _STATES:
        return Constant(_STATES[name.name])
    match scope.name(name.name):
        case Register(name=register):
            return RegisterValue(register)
        case Input(signal=signal, step=step):
            if step is not None:
                message = f"{name.text} is analogue: it must be alone on one side of a comparison"
                raise EvaluationError(name.place, "Y0472", message, _ANALOGUE)
            return InputValue(signal.variable, signal.name)
        case Amount() as found:
            return _plain(found, name)
        case None if name.name == "PI":
            return _known(name, scope)
        case None:
            known = sorted(set(scope.names(Amount, Register, Input)))
            subject = unknown(name.text, known)
            help_ = subject.question or (
                f"there are {', '.join(known[:8])}" if known else "declare it: REGISTER N 0..9"
            )
            message = f"no register, input or number is named {name.text}"
            raise EvaluationError(name.place, "Y0210", message, help_, subject)
        case found:
            message = f"{name.text} is {KINDS[type(found)]}, not a register, an input or a number"
            raise EvaluationError(name.place, "Y0209", message)


def _known(expression: Expression, scope: Scope) -> Constant:
    return _plain(evaluate(expression, scope), expression)


def _plain(found: Amount, expression: Expression) -> Constant:
    if found.unit is not None:
        message = f"{found} has a unit, but registers and inputs have none"
        raise EvaluationError(expression.place, "Y0307", message, "write a plain number")
    number = round(found.value, DECIMALS) + 0.0
    if not is_printed(found.value):
        message = (
            f"{found.value:.15g} has more than {DECIMALS} decimals, more than the controller's text can have"
        )
        raise EvaluationError(expression.place, "Y0434", message, f"round it: {number:.15g}")
    if abs(number) > LARGEST:
        raise EvaluationError(expression.place, "Y0403", f"{number:,.0f} is beyond {LARGEST:,}")
    return Constant(number)
