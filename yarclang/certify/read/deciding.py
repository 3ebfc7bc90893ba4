"""Reader of the conditions and computed values in a text's map, which must be in canonical form.

In this form every operation inside another one is in brackets, and nothing else is.
"""

from __future__ import annotations

import re

from yarclang.decisions import (
    DEEPEST,
    LONGEST_NAME,
    MOST_BITS,
    Before,
    Between,
    Constant,
    InputValue,
    RegisterValue,
    Value,
)

_TOKEN = re.compile(
    r"(?P<number>-?[0-9]{1,10}(?:\.[0-9]{1,9})?)|"
    rf"(?P<input>[MPQ][0-9]{{1,4}}(?:,[MPQ][0-9]{{1,4}}){{0,{MOST_BITS - 1}}})"
    rf"|\$(?P<register>[A-Z_][A-Z0-9_]{{0,{LONGEST_NAME - 1}}})|(?P<opens>\()"
)
_NEGATIVE = re.compile(r"-[0-9]")
_SIGN = re.compile(r"<=|>=|<>|[!&|=<>+*/%)-]")
_BETWEEN = {
    "|": "OR",
    "&": "AND",
    "=": "=",
    "<>": "<>",
    "<": "<",
    "<=": "<=",
    ">": ">",
    ">=": ">=",
    "+": "+",
    "-": "-",
    "*": "*",
    "/": "DIV",
    "%": "MOD",
}
_BEFORE = {"!": "NOT", "-": "-"}
_LOGICAL = ("OR", "AND", "NOT")
_COMPARISONS = ("=", "<>", "<", "<=", ">", ">=")


def read_value(text: str) -> Value | None:
    """Return the value or condition that a string denotes; None if it is not in canonical form."""
    return _Reading(text).whole()


def read_condition(text: str) -> Value | None:
    """Return the condition that a string denotes; None if it isn't canonical, or denotes a number."""
    value = read_value(text)
    return value if value is not None and _is_condition(value) else None


def read_assignment(text: str) -> tuple[RegisterValue | InputValue, Value] | None:
    """Return the target of an assignment and the number assigned; None if the string isn't canonical.

    The target is a register, or the variables of an output.
    """
    into, _, rest = text.partition(":=")
    target, value = read_value(into), read_value(rest)
    if not isinstance(target, RegisterValue | InputValue) or value is None or _is_condition(value):
        return None
    return target, value


def _is_condition(value: Value) -> bool:
    match value:
        case Before(operator=operator) | Between(operator=operator):
            return operator in _LOGICAL or operator in _COMPARISONS
    return False


class _Strange(Exception):  # noqa: N818 - ends the reading
    """The text is not in canonical form."""


class _Reading:
    """A text and the position up to which it has been read."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def whole(self) -> Value | None:
        try:
            value = self._value(0)
        except _Strange:
            return None
        return value if self._at == len(self._text) else None

    def _value(self, depth: int) -> Value:
        if depth > DEEPEST:
            raise _Strange
        sign = self._sign()
        if sign in _BEFORE and not _NEGATIVE.match(self._text, self._at):
            self._at += len(sign)
            operator = _BEFORE[sign]
            inner = self._operand(depth)
            _fits(inner, wants_condition=operator == "NOT")
            if operator == "-" and isinstance(inner, Constant):
                raise _Strange
            return Before(operator, inner)
        left = self._operand(depth)
        sign = self._sign()
        if sign not in _BETWEEN:
            if isinstance(left, Before | Between):
                raise _Strange  # superfluous brackets round the whole value
            return left
        self._at += len(sign)
        right = self._operand(depth)
        operator = _BETWEEN[sign]
        for one in (left, right):
            _fits(one, wants_condition=operator in _LOGICAL)
        return Between(operator, left, right)

    def _sign(self) -> str:
        """Return the sign at the current position; empty if there is none."""
        found = _SIGN.match(self._text, self._at)
        return found[0] if found is not None else ""

    def _operand(self, depth: int) -> Value:
        token = _TOKEN.match(self._text, self._at)
        if token is None:
            raise _Strange
        self._at = token.end()
        if token["number"]:
            return Constant(float(token["number"]))
        if token["input"]:
            return InputValue(token["input"])
        if token["register"]:
            return RegisterValue(token["register"])
        inner = self._value(depth + 1)
        if not isinstance(inner, Before | Between) or self._sign() != ")":
            raise _Strange
        self._at += 1
        return inner


def _fits(value: Value, *, wants_condition: bool) -> None:
    """Reject a number if a condition is needed, and a condition if a number is needed. The constants 0 and 1
    count as both.

    Raises:
        _Strange: the value is of the wrong sort.
    """
    is_known = isinstance(value, Constant) and value.number in (0.0, 1.0)
    if _is_condition(value) != wants_condition and not is_known:
        raise _Strange
