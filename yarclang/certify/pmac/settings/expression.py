"""Expressions of PLC 0: sums of variables times constants, evaluated exactly."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction

from yarclang.frozen import frozen

_TOKEN = re.compile(r"[0-9]{1,15}(?:\.[0-9]{1,30})?|[A-Z][0-9]{1,4}|[-+*/()]")
_DEEPEST = 8
"""Largest number of levels of nested parentheses."""


class NotAffineError(Exception):
    """A text is not a sum of variables times constants; the argument is the reason."""


@frozen
class Affine:
    """A constant plus a factor for each variable."""

    constant: Fraction
    factors: Mapping[str, Fraction]

    def plus(self, other: Affine, sign: int = 1) -> Affine:
        """Return the sum, or with `sign` -1 the difference."""
        factors = dict(self.factors)
        for name, factor in other.factors.items():
            factors[name] = factors.get(name, Fraction(0)) + sign * factor
        return Affine(self.constant + sign * other.constant, factors)

    def times(self, factor: Fraction) -> Affine:
        """Return the product with a constant."""
        return Affine(self.constant * factor, {name: old * factor for name, old in self.factors.items()})


def constant(value: Fraction) -> Affine:
    """Return a constant without variables."""
    return Affine(value, {})


def variable(name: str) -> Affine:
    """Return a single variable."""
    return Affine(Fraction(0), {name: Fraction(1)})


def evaluate(text: str, meaning: Callable[[str], Affine | None]) -> Affine:
    """Evaluate an expression of PLC 0 as the controller does.

    * and / come before + and -, from left to right (TUM, mathematical operators).

    Args:
        text: the expression, without spaces.
        meaning: function that takes a variable and returns its value; None for a variable that is not
            allowed.

    Raises:
        NotAffineError: the text is no expression, is not affine, or contains a variable that is not allowed.
    """
    return _Reader(text, meaning).whole()


class _Reader:
    """An expression with a position up to which it has been read."""

    def __init__(self, text: str, meaning: Callable[[str], Affine | None]) -> None:
        self._tokens: list[str] = []
        self._place = 0
        self._meaning = meaning
        place = 0
        while place < len(text):
            found = _TOKEN.match(text, place)
            if found is None:
                raise NotAffineError(f"'{text[place : place + 10]}' is no part of an expression")
            self._tokens.append(found[0])
            place = found.end()

    def whole(self) -> Affine:
        """Evaluate the whole expression."""
        value = self._sum(0)
        if self._next():
            raise NotAffineError(self._odd())
        return value

    def _sum(self, depth: int) -> Affine:
        if depth > _DEEPEST:
            raise NotAffineError(f"its parentheses are nested more than {_DEEPEST} deep")
        negative = self._take("-")
        value = self._product(depth)
        if negative:
            value = value.times(Fraction(-1))
        while sign := self._take("+") or self._take("-"):
            value = value.plus(self._product(depth), -1 if sign == "-" else 1)
        return value

    def _product(self, depth: int) -> Affine:
        value = self._factor(depth)
        while sign := self._take("*") or self._take("/"):
            factor = self._factor(depth)
            if sign == "/":
                if any(factor.factors.values()) or not factor.constant:
                    raise NotAffineError("it divides by something other than a constant that isn't 0")
                value = value.times(1 / factor.constant)
            elif not any(factor.factors.values()):
                value = value.times(factor.constant)
            elif not any(value.factors.values()):
                value = factor.times(value.constant)
            else:
                raise NotAffineError("it multiplies two variables")
        return value

    def _factor(self, depth: int) -> Affine:
        token = self._next()
        if token == "(":
            self._place += 1
            value = self._sum(depth + 1)
            if not self._take(")"):
                raise NotAffineError("a parenthesis isn't closed")
            return value
        if token[:1].isdigit():
            self._place += 1
            return constant(Fraction(token))
        if token[:1].isalpha():
            self._place += 1
            found = self._meaning(token)
            if found is None:
                raise NotAffineError(
                    f"it reads {token}, which is neither a motor's actual position nor its Ixx08"
                )
            return found
        raise NotAffineError(self._odd())

    def _next(self) -> str:
        """Return the next token without moving on; empty at the end."""
        return self._tokens[self._place] if self._place < len(self._tokens) else ""

    def _take(self, token: str) -> str:
        """Move past the next token and return it if it is the given one; else return an empty text."""
        if self._next() != token:
            return ""
        self._place += 1
        return token

    def _odd(self) -> str:
        """Return the fault of the next token in words."""
        token = self._next()
        return f"'{token}' is out of place" if token else "it ends too early"
