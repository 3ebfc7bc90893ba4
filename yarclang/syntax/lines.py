"""A line and its comment."""

from __future__ import annotations

import re

from yarclang.syntax.leaves import Place

_CODE = re.compile(r'(?:[^!"]|"[^"]*(?:"|$))*')


def code_of(line: str) -> str:
    """A line without its comment: what stands before the first `!` outside quotes."""
    if "!" not in line:
        return line
    match = _CODE.match(line)
    return match.group() if match else ""


def end_of(text: str) -> Place:
    """The place behind the last character of a statement that is no comment."""
    rows = text.split("\n")
    end = len(code_of(rows[-1]).rstrip()) + 1
    return Place(len(rows) - 1, end, end + 1)
