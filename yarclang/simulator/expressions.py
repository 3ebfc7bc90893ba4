"""Constants, expressions and conditions of the controller's language (TSRM 23, PUM 233).

Text comes without blanks and in upper case. What is read becomes a function of a `Scope`, so that a
program that is executed many times is parsed once.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from typing import Protocol

from yarclang.pmac.errors import DATA
from yarclang.simulator.reply import Refusal

LARGEST = 2.0**100
"""Values stay within this; what the controller itself does beyond its range is not known (assumed to saturate)."""

_DEEPEST = 40
_DIGITS = re.compile(r"\d{1,9}")
_NUMBER = re.compile(r"\$[0-9A-F]+|\d+\.?\d*|\.\d+")
_FUNCTION = re.compile(r"(ASIN|ACOS|ATAN2|ATAN|SIN|COS|TAN|LN|EXP|SQRT|ABS|INT)\(")
_COMPARATOR = re.compile(r"!=|!>|!<|!~|=|>|<|~")


class Scope(Protocol):
    """Where variables are read and written: all of the controller's, seen from one coordinate system."""

    def read(self, letter: str, index: int) -> float:
        """The value of a variable, `letter` one of I, P, Q, M."""
        ...

    def write(self, letter: str, index: int, value: float) -> None:
        """Give a variable a value."""
        ...


Expression = Callable[[Scope], float]
Condition = Callable[[Scope], bool]
Data = float | Expression


def value_of(data: Data, scope: Scope) -> float:
    """The value of a constant or an expression."""
    return data(scope) if callable(data) else data


def bounded(value: float) -> float:
    """A value within what the controller can hold; what isn't a number becomes 0 (assumed)."""
    if -LARGEST <= value <= LARGEST:
        return value
    if math.isnan(value):
        return 0.0
    return LARGEST if value > 0 else -LARGEST


class Reader:
    """A place in a text, and what can be read there. What doesn't fit is refused with ERR003."""

    def __init__(self, text: str, at: int = 0) -> None:
        self.text = text
        self.at = at
        self._depth = 0

    @property
    def ended(self) -> bool:
        """Whether nothing is left."""
        return self.at >= len(self.text)

    @property
    def rest(self) -> str:
        """What is left."""
        return self.text[self.at :]

    def takes(self, word: str) -> bool:
        """Whether `word` comes next; if so, it is read."""
        if self.text.startswith(word, self.at):
            self.at += len(word)
            return True
        return False

    def match(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """What fits the pattern here, read."""
        found = pattern.match(self.text, self.at)
        if found:
            self.at = found.end()
        return found

    def expect(self, word: str) -> None:
        """Read `word`, or refuse."""
        if not self.takes(word):
            raise Refusal(DATA)

    def has_data(self) -> bool:
        """Whether a constant or a parenthesis comes next."""
        rest = self.text[self.at : self.at + 2].lstrip("+-")
        return bool(rest) and (rest[0].isdigit() or rest[0] in ".$(")

    def constant(self) -> float:
        """A number with its sign."""
        sign = -1.0 if self.takes("-") else 1.0
        if sign > 0:
            self.takes("+")
        return sign * self._number()

    def whole(self) -> int:
        """Digits."""
        found = self.match(_DIGITS)
        if not found:
            raise Refusal(DATA)
        return int(found[0])

    def data(self) -> Data:
        """A constant, or an expression in parentheses (with a sign before it)."""
        sign = 1.0
        at = self.at
        if self.takes("-"):
            sign = -1.0
        else:
            self.takes("+")
        if self.takes("("):
            inner = self.expression()
            self.expect(")")
            return inner if sign > 0 else (lambda scope: -inner(scope))
        self.at = at
        return self.constant()

    def index(self) -> Data:
        """The number of a variable: a whole number, or an expression in parentheses."""
        if self.takes("("):
            inner = self.expression()
            self.expect(")")
            return inner
        return float(self.whole())

    def expression(self) -> Expression:
        """Sums of products; * / % & bind tighter than + - | ^ (PUM 233)."""
        self._deeper()
        left = self._product()
        while (sign := self._next()) and sign in "+-|^":
            self.at += 1
            left = _binary(_SUMS[sign], left, self._product())
        self._depth -= 1
        return left

    def condition(self) -> Condition:
        """Comparisons with AND and OR between them, AND first."""
        self._deeper()
        any_of = [self._conjunction()]
        while self.takes("OR"):
            any_of.append(self._conjunction())
        self._depth -= 1
        return any_of[0] if len(any_of) == 1 else (lambda scope: any(one(scope) for one in any_of))

    def _conjunction(self) -> Condition:
        all_of = [self._comparison()]
        while self.takes("AND"):
            all_of.append(self._comparison())
        return all_of[0] if len(all_of) == 1 else (lambda scope: all(one(scope) for one in all_of))

    def _comparison(self) -> Condition:
        at, depth = self.at, self._depth
        try:
            left = self.expression()
            found = self.match(_COMPARATOR)
            if not found:
                raise Refusal(DATA)
        except Refusal:
            self.at, self._depth = at, depth
            self.expect("(")
            inner = self.condition()
            self.expect(")")
            return inner
        compare, right = _COMPARISONS[found[0]], self.expression()
        return lambda scope: compare(left(scope), right(scope))

    def _product(self) -> Expression:
        left = self._factor()
        while (sign := self._next()) and sign in "*/%&":
            self.at += 1
            left = _binary(_PRODUCTS[sign], left, self._factor())
        return left

    def _factor(self) -> Expression:
        self._deeper()
        try:
            if self.takes("-"):
                inner = self._factor()
                return lambda scope: -inner(scope)
            if self.takes("+"):
                return self._factor()
            if self.takes("("):
                inner = self.expression()
                self.expect(")")
                return inner
            if found := self.match(_FUNCTION):
                inner = self.expression()
                self.expect(")")
                return _called(found[1], inner)
            if (letter := self._next()) and letter in "IPQM":
                self.at += 1
                return variable(letter, self.index())
            value = self._number()
            return lambda _scope: value
        finally:
            self._depth -= 1

    def _number(self) -> float:
        found = self.match(_NUMBER)
        if not found or len(found[0]) > 60:
            raise Refusal(DATA)
        return bounded(float(int(found[0][1:], 16)) if found[0][0] == "$" else float(found[0]))

    def _next(self) -> str:
        return self.text[self.at : self.at + 1]

    def _deeper(self) -> None:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise Refusal(DATA)


def variable(letter: str, index: Data) -> Expression:
    """The value of a variable."""
    if callable(index):
        return lambda scope: scope.read(letter, int(index(scope)))
    number = int(index)
    return lambda scope: scope.read(letter, number)


def _binary(function: Callable[[float, float], float], left: Expression, right: Expression) -> Expression:
    return lambda scope: bounded(function(left(scope), right(scope)))


def _quotient(left: float, right: float) -> float:
    """Division by zero saturates (assumed)."""
    if right == 0.0:
        return math.copysign(LARGEST, left) if left else 0.0
    return left / right


def _modulo(left: float, right: float) -> float:
    """For n > 0 from 0 to n; for n < 0 from -n to n (PUM 233)."""
    if right == 0.0:
        return 0.0
    if right > 0.0:
        return left % right
    return (left - right) % (-2.0 * right) + right


def _called(name: str, inner: Expression) -> Expression:
    """A function of an expression; angles are in degrees where I15 is 0."""

    def evaluate(scope: Scope) -> float:
        unit = math.pi / 180.0 if scope.read("I", 15) == 0.0 else 1.0
        try:
            return bounded(_FUNCTIONS[name](inner(scope), unit, scope))
        except (ValueError, OverflowError, ZeroDivisionError):
            # what lies outside of a function's range gives 0 (assumed)
            return 0.0

    return evaluate


_SUMS: dict[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "|": lambda left, right: float(int(left) | int(right)),
    "^": lambda left, right: float(int(left) ^ int(right)),
}

_PRODUCTS: dict[str, Callable[[float, float], float]] = {
    "*": operator.mul,
    "/": _quotient,
    "%": _modulo,
    "&": lambda left, right: float(int(left) & int(right)),
}

_COMPARISONS: dict[str, Callable[[float, float], bool]] = {
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
