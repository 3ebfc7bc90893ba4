"""Convert one text to another by few edits, so that an editor keeps its cursor in unchanged lines."""

from __future__ import annotations

from difflib import SequenceMatcher

from yarclang.diagnostics import Edit
from yarclang.source import SourceFile, Span, lines_with_ends
from yarclang.syntax.form import usual_form

_MOST_LINES = 3_000
"""Largest number of lines that are compared. A longer range is replaced as a whole, because comparing it
takes too long.
"""


def changes_to(source: SourceFile, text: str) -> tuple[Edit, ...]:
    """Return edits of whole lines that change a source into another text."""
    before, after = lines_with_ends(source.text), lines_with_ends(text)
    first = 0
    while first < min(len(before), len(after)) and before[first] == after[first]:
        first += 1
    last = 0
    while last < min(len(before), len(after)) - first and before[-1 - last] == after[-1 - last]:
        last += 1
    old, new = before[first : len(before) - last], after[first : len(after) - last]
    if not old and not new:
        return ()
    if max(len(old), len(new)) > _MOST_LINES:
        return (_edit(before, first, first + len(old), "".join(new)),)
    opcodes = SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
    return tuple(
        _edit(before, first + i1, first + i2, "".join(new[j1:j2]))
        for tag, i1, i2, j1, j2 in opcodes
        if tag != "equal"
    )


def _edit(lines: list[str], begin: int, end: int, text: str) -> Edit:
    """Return an edit that replaces the lines `begin` to `end` (exclusive, from 0).

    If the last line has no line end, the range ends after its last character.
    """
    return Edit(Span(*_at(lines, begin), *_at(lines, end)), text)


def _at(lines: list[str], number: int) -> tuple[int, int]:
    if number == len(lines) and lines and not lines[-1].endswith(("\n", "\r")):
        return number, len(lines[-1]) + 1
    return number + 1, 1


def formatted(source: SourceFile, renumber: tuple[int, int] | None = None) -> tuple[Edit, ...] | None:
    """Return the edits that format a program as `yarc fmt` does.

    Args:
        source: the program.
        renumber: first command number and step between numbers; None keeps the numbers.

    Returns:
        None if the program has syntax errors, or if the formatted program isn't proved to mean the same.
    """
    text = usual_form(source, renumber).value
    return None if text is None else changes_to(source, text)
