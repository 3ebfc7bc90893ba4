"""A syntax error, and descriptions of the parser's state at the error.

The parser reports the unexpected token and the kinds of tokens that were possible (`expected`). It also
reports what it has read but not yet combined (`stack`: tokens, and constructs such as waypoints).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from yarclang.frozen import frozen
from yarclang.subjects import Subject
from yarclang.syntax.leaves import Place, place_of

_CLOSING = {"[": "]", "(": ")", "$(": ")", "{": "}"}


@frozen
class Fault:
    """A syntax error, with its place relative to the statement.

    `edits` are a safe fix: pairs of a place and its new text; `title` describes them. Most errors have none.
    """

    code: str
    message: str
    help: str
    place: Place
    title: str = ""
    edits: tuple[tuple[Place, str], ...] = ()
    subject: Subject | None = None


class FaultError(Exception):
    """A syntax error that is found while the syntax tree is built."""

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault.message)
        self.fault = fault


def kind_of(one: Any) -> str:
    """Return the type of a token, or the name of the grammar's rule that a tree stands for."""
    return str(getattr(one, "type", None) or getattr(one, "data", ""))


def shown(token: Any) -> str:
    """Return a token's text; for a token with several numbers, the first."""
    text = str(token)
    if token.type == "NUMBERS" and text.split():
        text = text.split(maxsplit=1)[0]
    return text[:40]


def called(token: Any) -> str:
    """Return a description of a token for use in a sentence."""
    text = shown(token)
    names = {
        "FRAME": f"the frame {text}",
        "LSQB": "a motion time",
        "LPAR": "a list of units",
        "NUMBERS": f"the value {text}",
        "NUMBER": f"the value {text}",
        "INDEX": f"a second index {text}",
        "_SEMICOLON": "a semicolon",
        "RSQB": "a closing bracket `]`",
        "RPAR": "a closing bracket `)`",
        "COMMA": "a comma",
        "STRING": "a text",
        "OPEN": "an expression",
    }
    return names.get(token.type, f"`{text}`")


def open_brackets(stack: Sequence[Any]) -> list[Any]:
    """Return the brackets `(` and `$(` that are open, innermost last."""
    brackets: list[Any] = []
    for one in stack:
        if kind_of(one) in {"LPAR", "OPEN"}:
            brackets.append(one)
        elif kind_of(one) == "RPAR":
            brackets.pop()
    return brackets


def unclosed(stack: Sequence[Any]) -> Fault:
    """Return the fault of the innermost open bracket; there must be one."""
    brackets = [one for one in stack if kind_of(one) == "LSQB"] + open_brackets(stack)
    return not_closed(str(brackets[-1]), place_of(brackets[-1]))


def not_closed(opening: str, place: Place) -> Fault:
    """Return the syntax error of a bracket without its partner."""
    return Fault("Y0102", f"this `{opening}` is not closed", f"close it with `{_CLOSING[opening]}`", place)
