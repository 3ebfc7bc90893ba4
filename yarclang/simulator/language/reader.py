"""Reader of constants, lists, expressions and conditions in a line of the controller's language (TSRM 23, PUM
233).

The line is in upper case, without blanks. Expressions become functions of a `Scope`, so that a program
is parsed only once, however often it is executed.
"""

from __future__ import annotations

import re

from yarclang.pmac.errors import DATA
from yarclang.simulator.language.arithmetic import (
    COMPARISONS,
    PRODUCTS,
    SUMS,
    Condition,
    Data,
    Expression,
    bounded,
    called,
    combined,
    variable,
)
from yarclang.simulator.network.reply import Refusal

_DEEPEST = 40
_DIGITS = re.compile(r"\d{1,9}")
_NUMBER = re.compile(r"\$[0-9A-F]+|\d+\.?\d*|\.\d+")
_NUMBERS = re.compile(r"\d{1,3}(?:\.\.\d{1,3})?(?:,\d{1,3}(?:\.\.\d{1,3})?)*")
_FUNCTION = re.compile(r"(ASIN|ACOS|ATAN2|ATAN|SIN|COS|TAN|LN|EXP|SQRT|ABS|INT)\(")
_COMPARATOR = re.compile(r"!=|!>|!<|!~|=|>|<|~")


class Reader:
    """A text and a position from which it is read. Unexpected text is refused with ERR003."""

    def __init__(self, text: str, at: int = 0) -> None:
        self.text = text
        self.at = at
        self._depth = 0

    @property
    def ended(self) -> bool:
        """True at the end of the text."""
        return self.at >= len(self.text)

    @property
    def rest(self) -> str:
        """The rest of the text."""
        return self.text[self.at :]

    def takes(self, word: str) -> bool:
        """Read `word` if it is next. Return True if it was."""
        if self.text.startswith(word, self.at):
            self.at += len(word)
            return True
        return False

    def match(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """Read the text at the position if it matches the pattern, and return the match; None if it doesn't
        match.
        """
        found = pattern.match(self.text, self.at)
        if found:
            self.at = found.end()
        return found

    def expect(self, word: str) -> None:
        """Read `word`.

        Raises:
            Refusal: ERR003 if it isn't next.
        """
        if not self.takes(word):
            raise Refusal(DATA)

    def has_data(self) -> bool:
        """Return True if a constant or a parenthesis is next."""
        rest = self.text[self.at : self.at + 2].lstrip("+-")
        return bool(rest) and (rest[0].isdigit() or rest[0] in ".$(")

    def constant(self) -> float:
        """Read a number with its sign."""
        sign = -1.0 if self.takes("-") else 1.0
        if sign > 0:
            self.takes("+")
        return sign * self._number()

    def whole(self) -> int:
        """Read an integer without a sign."""
        found = self.match(_DIGITS)
        if not found:
            raise Refusal(DATA)
        return int(found[0])

    def numbers(self, largest: int) -> tuple[int, ...]:
        """Read a list of integers: `1`, `1,3` or `1..4`.

        Raises:
            Refusal: ERR003 without a list, or for an integer beyond `largest`.
        """
        found = self.match(_NUMBERS)
        if not found:
            raise Refusal(DATA)
        numbers: list[int] = []
        for part in found[0].split(","):
            first, _, last = part.partition("..")
            numbers += range(int(first), int(last or first) + 1)
        if not numbers or max(numbers) > largest:
            raise Refusal(DATA)
        return tuple(numbers)

    def data(self) -> Data:
        """Read a constant, or an expression in parentheses. A sign may precede the parentheses."""
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
        """Read the number of a variable: an integer, or an expression in parentheses."""
        if self.takes("("):
            inner = self.expression()
            self.expect(")")
            return inner
        return float(self.whole())

    def expression(self) -> Expression:
        """Read an expression; * / % & bind tighter than + - | ^ (PUM 233)."""
        self._deeper()
        result = self._product()
        while (sign := self._next()) and sign in "+-|^":
            self.at += 1
            result = combined(SUMS[sign], result, self._product())
        self._depth -= 1
        return result

    def condition(self) -> Condition:
        """Read comparisons with AND and OR between them; AND binds tighter."""
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
            result = self.expression()
            match = self.match(_COMPARATOR)
            if not match:
                raise Refusal(DATA)
        except Refusal:
            self.at, self._depth = at, depth
            self.expect("(")
            inner = self.condition()
            self.expect(")")
            return inner
        compare, right = COMPARISONS[match[0]], self.expression()
        return lambda scope: compare(result(scope), right(scope))

    def _product(self) -> Expression:
        left = self._factor()
        while (sign := self._next()) and sign in "*/%&":
            self.at += 1
            left = combined(PRODUCTS[sign], left, self._factor())
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
                return called(found[1], inner)
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
