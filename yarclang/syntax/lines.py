"""Separate a line from its comment."""

from __future__ import annotations

import re

from yarclang.syntax.leaves import Place
from yarclang.syntax.words import DECLARATIONS

_CODE = re.compile(r'(?:[^!"]++|"[^"]*+"?+)*+')
_OPENS_STATEMENT = re.compile(
    rf"\s*(?:[Pp][0-9]+|{'|'.join(sorted(DECLARATIONS))})(?![^\s;\[\](){{}}!,\"])", re.I
)
_TEXT = re.compile(r'"[^"]*"?')


def code_of(line: str) -> str:
    """Return a line without its comment, which begins with the first `!` outside of quotes.

    Brackets and braces needn't be considered: of all tokens of the grammar, only a text in quotes may contain
    a `!`.
    """
    if "!" not in line:
        return line
    match = _CODE.match(line)
    return match.group() if match else ""


def texts_of(code: str) -> list[re.Match[str]]:
    """Return the texts in quotes in a line's code. A text without its closing quote extends to the end."""
    return list(_TEXT.finditer(code))


def opens_statement(code: str) -> bool:
    """Return True if a line begins with an index or with the word of a declaration: such a line never
    continues the line before.
    """
    return _OPENS_STATEMENT.match(code) is not None


def end_of(text: str) -> Place:
    """Return the place directly after the code of a statement's last row, before the row's comment."""
    rows = text.split("\n")
    end = len(code_of(rows[-1]).rstrip()) + 1
    return Place(len(rows) - 1, end, end + 1)
