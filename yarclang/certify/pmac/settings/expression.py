"""The expressions of PLC 0: sums of variables times constants, evaluated exactly."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction

from yarclang.frozen import frozen

_TOKEN = re.compile(r"[0-9]{1,15}(?:\.[0-9]{1,30})?|[A-Z][0-9]{1,4}|[-+*/()]")
_DEEPEST = 8
"""Most parentheses in each other."""


class NotAffineError(Exception):
    """Error for a text that isn't a sum of variables times constants; the argument says why."""


@frozen
class Affine:
    """A constant and a factor for each variable."""

    constant: Fraction
    factors: Mapping[str, Fraction]

    def plus(self, other: Affine, sign: int = 1) -> Affine:
        """Add, or with `sign` -1 subtract."""
        factors = dict(self.factors)
        for name, factor in other.factors.items():
            factors[name] = factors.get(name, Fraction(0)) + sign * factor
        return Affine(self.constant + sign * other.constant, factors)

    def times(self, factor: Fraction) -> Affine:
        """Multiply by a constant."""
        return Affine(self.constant * factor, {name: old * factor for name, old in self.factors.items()})


def constant(value: Fraction) -> Affine:
    """Return a value without variables."""
    return Affine(value, {})


def variable(name: str) -> Affine:
    """Return a variable by itself."""
    return Affine(Fraction(0), {name: Fraction(1)})


def evaluate(text: str, meaning: Callable[[str], Affine | None]) -> Affine:
    """Evaluate an expression as the controller does: * and / before + and -, from left to right (TUM, mathematical operators).

    Args:
        text: the expression, without spaces.
        meaning: the value of a variable, or None if the expression must not name it.

    Raises:
        NotAffineError: the text is no expression, isn't affine, or names another variable.
    """
    return _Reader(text, meaning).whole()


class _Reader:
    """The place in an expression."""

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
        """Evaluate everything."""
        value = self._sum(0)
        if self._next():
            raise NotAffineError(self._odd())
        return value

    def _sum(self, depth: int) -> Affine:
        if depth > _DEEPEST:
            raise NotAffineError(f"it has more than {_DEEPEST} parentheses in each other")
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
            other = self._factor(depth)
            if sign == "/":
                if any(other.factors.values()) or not other.constant:
                    raise NotAffineError("it divides by something other than a constant above or below 0")
                value = value.times(1 / other.constant)
            elif not any(other.factors.values()):
                value = value.times(other.constant)
            elif not any(value.factors.values()):
                value = other.times(value.constant)
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
        """Return the next token and leave it where it is; empty at the end."""
        return self._tokens[self._place] if self._place < len(self._tokens) else ""

    def _take(self, token: str) -> str:
        """Take the next token if it is this one; else return nothing."""
        if self._next() != token:
            return ""
        self._place += 1
        return token

    def _odd(self) -> str:
        """Say what is wrong with the next token."""
        token = self._next()
        return f"'{token}' is out of place" if token else "it ends too early"
