"""Replace the findings of a line that can't be read by a single one, if one of the functions of this package
recognises the mistake.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.findings import SYNTAX, family_of
from yarclang.mistakes import (
    actions,
    behind,
    blocks,
    calls,
    characters,
    comments,
    declarations,
    expressions,
    foreign,
    goals,
    indices,
    numbers,
    parts,
    sensed,
    words,
)
from yarclang.mistakes.line import Around, Guess, Guesser, Line, first
from yarclang.mistakes.names import named
from yarclang.progress import each
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Statement
from yarclang.syntax.lines import code_of
from yarclang.syntax.parse import parse_statement

_FAMILIES = (SYNTAX, "02", "03", "04")
"""Families of findings that mean that a line can't be read: syntax, names, frames and units, values."""

_NO_INDEX, _NO_UNIT, _NO_END, _NO_BLOCK = "Y0105", "Y0304", "Y0113", "Y0114"
_NO_TEXT, _CHARACTER = "Y0108", "Y0118"

_UNDERSTOOD = frozenset((_NO_INDEX, _NO_UNIT, _NO_TEXT))
"""Codes of findings that are ignored although they belong to `_FAMILIES`. These findings are about lines that
can be read, or about a file that is no program.
"""

_MOST_LINES = 200
"""Largest number of lines with errors that are examined. A file with more of them is probably no program."""

_LONGEST = 400
"""Largest number of characters in a line that is examined. Longer lines weren't typed by a person."""

GUESSERS: tuple[Guesser, ...] = (
    characters.alike,
    comments.whole,
    foreign.numbered,
    indices.index,
    blocks.end,
    calls.request,
    foreign.foreign,
    calls.call,
    declarations.declared,
    expressions.sum_,
    comments.behind,
    blocks.condition,
    blocks.hold,
    sensed.until,
    sensed.watch,
    actions.signal,
    actions.turned,
    actions.wait,
    actions.rounds,
    blocks.several,
    blocks.assignment,
    words.relative,
    words.suffix,
    parts.bracket,
    parts.units,
    behind.behind,
    parts.time,
    parts.order,
    numbers.decimal_commas,
    numbers.value_list,
    goals.named,
    goals.several,
    goals.along,
    goals.apart,
    parts.frame,
    parts.option,
    numbers.number,
    words.word,
)
"""Guessers in the order in which they are tried. The first ones need the fewest correct parts in a line."""


def answered(diagnostics: Iterable[Diagnostic], source: SourceFile) -> tuple[Diagnostic, ...]:
    """Return the findings of a program. If the mistake in a line that can't be read is recognised, a finding
    about this mistake replaces all findings of the line.

    The new finding has the code of the line's error at the mistake's own place, or else of its first error.
    It has a fix if only one repair is likely.

    Args:
        diagnostics: all findings.
        source: the program's file.
    """
    found = tuple(diagnostics)
    wrong: dict[int, list[Diagnostic]] = {}
    for one in each(found):
        if _is_of_the_line(one) and (line := _line(one, source)):
            wrong.setdefault(line, []).append(one)
    around = Around(source)
    if not wrong:
        return tuple(named(one, source, around) if _line(one, source) else one for one in found)
    answers: dict[int, Diagnostic] = {}
    ends, begins = 0, list[int]()
    for number in each(sorted(wrong)[:_MOST_LINES]):
        text = source.line(number)
        if len(text) > _LONGEST or all(
            one.fix is not None and one.code == _CHARACTER for one in wrong[number]
        ):
            continue
        after = source.line(number + 1) if number < len(source.lines) else ""
        if guess := first(Line(text, number, around, after), GUESSERS):
            answers[number] = _answer(wrong[number], guess, text)
            ends += guess.ends_block
            if guess.begins_block:
                begins.append(number)
    told: list[Diagnostic] = []
    for one in found:
        line = _line(one, source)
        if one.code == _NO_END and ends:
            ends -= 1  # the finding about the line that was meant as END replaces this one
        elif one.code == _NO_BLOCK and line not in answers and begins and begins[0] < line:
            begins.pop(0)  # the finding about the intended first line replaces this one
        elif line not in answers or (one.code == _NO_INDEX and answers[line].fix is not None):
            told.append(one)
        elif one is wrong[line][0]:
            told.append(answers[line])
        elif not _is_of_the_line(one) and one.code != _NO_INDEX:
            told.append(one)
    return tuple(named(one, source, around) if _line(one, source) else one for one in told)


def _is_of_the_line(one: Diagnostic) -> bool:
    """Return True if a finding says that its line can't be read."""
    return one.is_error and one.code not in _UNDERSTOOD and family_of(one.code) in _FAMILIES


def _line(one: Diagnostic, source: SourceFile) -> int:
    """Return the number of the program's line that a finding is about; 0 if the finding is about another file
    or several lines.
    """
    if (
        one.source is not source
        or one.span is None
        or one.within is not None
        or one.span.line != one.span.end_line
    ):
        return 0
    return one.span.line


def _answer(wrong: list[Diagnostic], guess: Guess, text: str) -> Diagnostic:
    assert wrong[0].span is not None  # a finding about a line has a span
    number = wrong[0].span.line
    span = Span.on_line(number, guess.begin + 1, max(guess.end, guess.begin + 1) + 1)
    one = next((error for error in wrong if error.span == span), wrong[0])
    fix = None
    if guess.lines and all(_is_read(line) for line in guess.lines):
        unread = any(family_of(each_.code) == SYNTAX for each_ in wrong)
        fix = Fix(guess.help, (_edit(number, text, guess.lines),), uncovers=unread)
    return replace(one, message=guess.message, help=guess.help, span=span, fix=fix, subject=None)


def _is_read(line: str) -> bool:
    """Return True if a line can be parsed, whatever its names mean."""
    return not code_of(line).strip() or isinstance(parse_statement(line), Statement)


def _edit(number: int, text: str, lines: tuple[str, ...]) -> Edit:
    """Return the smallest edit that replaces a line by other lines.

    Args:
        number: number of the line, from 1.
        text: the line.
        lines: the new lines.
    """
    put = "\n".join(lines)
    begin = 0
    while begin < min(len(text), len(put)) and text[begin] == put[begin]:
        begin += 1
    end = 0
    while end < min(len(text), len(put)) - begin and text[-1 - end] == put[-1 - end]:
        end += 1
    return Edit(Span.on_line(number, begin + 1, len(text) - end + 1), put[begin : len(put) - end])
