"""Expressions as they are written: no name is resolved, and no value is computed.

The tree has the language's precedence: `A + B*C` is a sum whose second operand is a product. Brackets are
nodes of their own, so that a tree can be printed as it was written.
"""

from __future__ import annotations

from typing import Literal

from yarclang.frozen import frozen
from yarclang.syntax.leaves import Number, Place, Quantity, Word

UnaryOperator = Literal["NOT", "+", "-"]
BinaryOperator = Literal["OR", "AND", "=", "<>", "<", "<=", ">", ">=", "+", "-", "*", "/", "%", "**"]

DEEPEST_EXPRESSION = 100
"""Largest depth of operators, functions and brackets. A deeper expression is a fault. This limits the
recursion of code that walks through a tree.
"""


@frozen
class Name:
    """The name of a number: `PITCH`, `PALLET.PITCH`, or `PI`; `name` is its upper-case form."""

    text: str
    place: Place

    @property
    def name(self) -> str:
        """Return the name in the form in which names are compared."""
        return self.text.upper()


@frozen
class Bracket:
    """An expression in round brackets."""

    inner: Expression
    place: Place


@frozen
class Unary:
    """An operator before its operand."""

    operator: UnaryOperator
    operand: Expression
    place: Place


@frozen
class Binary:
    """An operator between its operands."""

    operator: BinaryOperator
    left: Expression
    right: Expression
    place: Place


@frozen
class Function:
    """A call of a built-in function (words.FUNCTIONS). The number of arguments was checked."""

    word: Word
    arguments: tuple[Expression, ...]
    place: Place

    @property
    def name(self) -> str:
        """Return the function's name in upper case."""
        return self.word.name


@frozen
class Element:
    """A number of a TABLE, with one index or two: `HEIGHTS[I]`, `SPOTS[I, 1]`."""

    table: Name
    indices: tuple[Expression, ...]
    place: Place


@frozen
class Applied:
    """A call of a FUNC that the program or a module declares: `MID(A, B)`."""

    function: Name
    arguments: tuple[Expression, ...]
    place: Place


Expression = Number | Quantity | Name | Bracket | Unary | Binary | Function | Element | Applied


def is_too_deep(expression: Expression) -> bool:
    """Return True if an expression is nested deeper than DEEPEST_EXPRESSION."""
    if expression.place.end - expression.place.start <= DEEPEST_EXPRESSION:
        return False  # each level has at least one character
    level = [expression]
    for _ in range(DEEPEST_EXPRESSION):
        level = [part for one in level for part in parts_of(one)]
        if not level:
            return False
    return True


def parts_of(expression: Expression) -> tuple[Expression, ...]:
    """Return the direct subexpressions, from left to right."""
    match expression:
        case Binary():
            return expression.left, expression.right
        case Unary():
            return (expression.operand,)
        case Bracket():
            return (expression.inner,)
        case Function():
            return expression.arguments
        case Element():
            return expression.table, *expression.indices
        case Applied():
            return expression.function, *expression.arguments
        case _:
            return ()
