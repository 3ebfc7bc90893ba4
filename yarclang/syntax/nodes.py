"""Build the syntax nodes of expressions as soon as Lark has read their operands."""

from __future__ import annotations

from typing import Any, cast

from yarclang.syntax.expressions import (
    Applied,
    Binary,
    BinaryOperator,
    Bracket,
    Element,
    Expression,
    Function,
    Name,
    Unary,
    UnaryOperator,
)
from yarclang.syntax.faults import Fault, FaultError
from yarclang.syntax.leaves import Number, Place, Quantity, Word, from_to, place_of
from yarclang.syntax.words import CONSTANTS, FUNCTIONS, OPERATORS


class Nodes:
    """Builder of the syntax nodes of expressions. Each method is named after the rule or alias of the grammar
    for which it builds a node.
    """

    def name(self, children: list[Any]) -> Name:
        """Build the name of a number."""
        (token,) = children
        return named(str(token), place_of(token))

    def number(self, children: list[Any]) -> Number:
        """Build a number."""
        (token,) = children
        return Number(str(token), float(token), place_of(token))

    def quantity(self, children: list[Any]) -> Quantity:
        """Build a number with its unit."""
        number, _, unit, end = children
        value = self.number([number])
        return Quantity(value, Word(str(unit), place_of(unit)), from_to(value.place, place_of(end)))

    def bracket(self, children: list[Any]) -> Bracket:
        """Build an expression in brackets."""
        opening, inner, closing = children
        return Bracket(inner, from_to(place_of(opening), place_of(closing)))

    def unary(self, children: list[Any]) -> Unary:
        """Build a sign or NOT, and its operand."""
        sign, operand = children
        operator = cast("UnaryOperator", str(sign).upper())
        return Unary(operator, operand, from_to(place_of(sign), operand.place))

    def binary(self, children: list[Any]) -> Binary:
        """Build an operator between two operands."""
        left, sign, right = children
        operator = cast("BinaryOperator", str(sign).upper())
        return Binary(operator, left, right, from_to(left.place, right.place))

    def function(self, children: list[Any]) -> Function | Applied:
        """Build the call of a built-in function, or of a function that the program declares. For a built-in
        function, check the number of arguments.
        """
        token, _, *arguments, closing = children
        word = Word(str(token), place_of(token))
        place = from_to(word.place, place_of(closing))
        values = tuple(one for one in arguments if getattr(one, "type", None) != "COMMA")
        _check_function(word, values, place)
        if word.name not in FUNCTIONS:
            return Applied(Name(word.text, word.place), values, place)
        return Function(word, values, place)

    def element(self, children: list[Any]) -> Element:
        """Build a number of a table, with its index or indices."""
        token, *indices, closing = children
        place = place_of(token)
        table = named(str(token)[:-1], Place(place.row, place.start, place.end - 1))
        values = tuple(one for one in indices if getattr(one, "type", None) != "COMMA")
        return Element(table, values, from_to(table.place, place_of(closing)))


def named(text: str, place: Place) -> Name:
    """Build the syntax node of a name in an expression.

    Raises:
        FaultError: the name is that of a function or an operator.
    """
    if text.upper() in FUNCTIONS or text.upper() in OPERATORS:
        kind = "a function" if text.upper() in FUNCTIONS else "an operator"
        help_ = f"write {text.upper()}(...)" if text.upper() in FUNCTIONS else "choose another name"
        raise FaultError(
            Fault("Y0101", f"{text.upper()} is {kind}, and can't be the name of a number", help_, place)
        )
    return Name(text, place)


def _check_function(word: Word, arguments: tuple[Expression, ...], place: Place) -> None:
    if word.name not in FUNCTIONS:
        if word.name in CONSTANTS:
            message, help_ = f"{word.name} is a number and takes no argument", "take the brackets away"
        elif not arguments:
            message, help_ = (
                f"{word.text}() has no argument",
                f"give it an argument; for the number of this name write ${word.text}",
            )
        else:
            return
        raise FaultError(Fault("Y0109", message, help_, word.place))
    least, most = FUNCTIONS[word.name]
    given = len(arguments)
    if given < least or (most is not None and given > most):
        wanted = f"{least} or more arguments" if most is None else f"{least} argument{'s' * (least > 1)}"
        message = f"{word.name} takes {wanted}, {given} {'is' if given == 1 else 'are'} given"
        help_ = {1: f"write {word.name}(A)", 2: f"write {word.name}(A, B)"}[least]
        if word.name == "ATAN2":
            help_ = "write ATAN2(y, x)"
        if given > least:
            help_ += "; the decimal sign is a point"
        raise FaultError(Fault("Y0110", message, help_, place))
