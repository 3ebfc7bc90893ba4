"""Statements as most lines have them, read by one regular expression: no expression, no text in quotes.

    P0001 MOVEJ_RPY_LSPB {TCP} 0.00 1174.40 1176.00 0.00 0.00 0.00 [20] (mm,deg,s) {B} BLEND 5 ! to the part

A way-point list over several lines is read as if it stood in one, and its places are put right afterwards.

Lark reads the same statement in six times the time, and has to be imported first. The expression is put together of the grammar's own terminals; what it doesn't
match is left to the grammar, and what it matches is to the last column what the grammar gives (tests/syntax/test_plain.py).
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping
from functools import cache, lru_cache
from itertools import accumulate
from pathlib import Path

from yarclang.frozen import frozen
from yarclang.syntax.ast import (
    FrameName,
    Number,
    Option,
    Percent,
    Place,
    Statement,
    Time,
    Units,
    WayPoint,
    Word,
)
from yarclang.syntax.build import comments_of
from yarclang.syntax.lines import code_of

GRAMMAR = Path(__file__).parent.parent / "grammar.lark"

_TERMINAL = re.compile(r"^([A-Z_]+)(?:\.-?\d+)?: /(.*)/(i?)$", re.MULTILINE)
_TOKEN = re.compile(r"\S+")
_UNIT = re.compile(r"[^\s,()]+")
_NUMBER_BEGINS = frozenset("+-.0123456789")


def terminals() -> Mapping[str, str]:
    """The grammar's terminals that are regular expressions, by their names."""
    return {
        name: f"(?i:{pattern})" if flag else f"(?:{pattern})"
        for name, pattern, flag in _TERMINAL.findall(GRAMMAR.read_text(encoding="utf-8"))
    }


@cache
def _form() -> re.Pattern[str]:
    """A whole statement. Each part is taken as the grammar's lexer takes it, and never given back: where something else follows, nothing matches."""
    said = terminals()
    index, frame, numbers, percent, option = (
        said[name] for name in ("INDEX", "FRAME", "NUMBERS", "PERCENT", "OPTION")
    )
    others = "|".join(said[name] for name in ("CALL", "SUB", "LET", "IF", "LONE"))
    word = f"(?:(?!{option}){said['WORD']})"
    blank = "[ \t]*+"
    values = rf"(?:(?>{numbers}|{word}){blank})++"
    return re.compile(
        rf"{blank}(?:({index}){blank})?+(?!{others})(?>({said['WORD']})){blank}"
        rf"(?:({frame}){blank})?+"
        rf"((?:{values}(?:;{blank}{values})*+)?+)"
        rf"(\[{blank}(?>{percent}|{numbers}|{said['WORD']}{blank}(?:{numbers})?+){blank}\])?+{blank}"
        rf"(\({blank}(?>{said['WORD']}){blank}(?:,{blank}(?>{said['WORD']}){blank})*+\))?+{blank}"
        rf"(?:({frame}){blank})?+"
        rf"((?:(?>{option}){blank}(?:(?>{percent}|{numbers}|{word}){blank})?+)*+)"
        r"(?:![^\n]*+)?\Z"
    )


@cache
def _option_form() -> re.Pattern[str]:
    """One option and its argument, among several."""
    said = terminals()
    argument = f"{said['PERCENT']}|{said['NUMBERS']}|(?!{said['OPTION']}){said['WORD']}"
    return re.compile(rf"({said['OPTION']})[ \t]*+(?>({argument}))?+")


def plain_statement(text: str) -> Statement | None:
    """The statement of a text; `line` is 0 until the caller sets it. None where it takes the grammar to read it."""
    if "\n" in text:
        rows = text.split("\n")
        code = [row if "!" not in row else code_of(row).ljust(len(row)) for row in rows]
        if any('"' in row for row in code) or not all(_goes_on(row) for row in code[:-1]):
            return None
        flat = " ".join(code)
        places = _Rows(tuple(accumulate((len(row) + 1 for row in rows), initial=0)))
    else:
        rows, flat, places = [text], text, _ONE_ROW
    match = _form().match(flat)
    if match is None:
        return None
    if len(rows) > 1 and any("\n" in text[slice(*match.span(group))] for group in (3, 5, 6, 7, 8)):
        return None
    index, name, moving, values, time, units, base, options = match.groups()
    named = tuple(_options(match, places)) if options else ()
    if None in named:
        return None
    return Statement(
        0,
        len(rows),
        Word(index, places.of(match, 1)) if index else None,
        places.word(name, match.start(2)),
        FrameName(moving, places.of(match, 3)) if moving else None,
        tuple(_waypoints(flat, *match.span(4), places)) if values else (),
        None,
        _time(match, places) if time else None,
        Units(tuple(_words(flat, *match.span(6), places)), places.of(match, 6)) if units else None,
        FrameName(base, places.of(match, 7)) if base else None,
        named,  # type: ignore[arg-type]
        comments_of(text),
    )


def _goes_on(row: str) -> bool:
    """Return True if a list may go on in the row after this one."""
    code = row.rstrip(" \t")
    return not code or code.endswith(";")


@frozen
class _Rows:
    """Where the characters of a flat text stand: `begins` are the numbers of its rows' first ones, and one more."""

    begins: tuple[int, ...]

    def at(self, begin: int, end: int) -> Place:
        """The place of the characters from `begin` up to `end` (not included)."""
        if len(self.begins) == 2:
            return _at(begin + 1, end + 1)
        row = bisect_right(self.begins, begin) - 1
        return Place(row, begin - self.begins[row] + 1, end - self.begins[row] + 1)

    def of(self, match: re.Match[str], group: int) -> Place:
        """The place of a group."""
        return self.at(*match.span(group))

    def word(self, token: str, begin: int) -> Word:
        """A word that begins at a character."""
        if len(self.begins) == 2:
            return _word(token, begin + 1)
        return Word(token, self.at(begin, begin + len(token)))

    def number(self, token: str, begin: int) -> Number:
        """Return the number that begins at a character; short ones, which come again and again, are shared."""
        if len(self.begins) == 2 and len(token) <= _SHORT:
            return _number(token, begin + 1)
        return Number(token, float(token), self.at(begin, begin + len(token)))


_SHORT = 5
_ONE_ROW = _Rows((0, 0))


@lru_cache(maxsize=1 << 16)
def _at(start: int, end: int) -> Place:
    """Return columns of a line: the lines of a long program have the same ones, and share them."""
    return Place(0, start, end)


@lru_cache(maxsize=1 << 14)
def _word(token: str, start: int) -> Word:
    return Word(token, _at(start, start + len(token)))


@lru_cache(maxsize=1 << 14)
def _number(token: str, start: int) -> Number:
    return Number(token, float(token), _at(start, start + len(token)))


def _waypoints(text: str, begin: int, end: int, places: _Rows) -> Iterator[WayPoint]:
    """The way-points between semicolons."""
    while begin < end:
        found = text.find(";", begin, end)
        last = end if found < 0 else found
        yield WayPoint(tuple(_items(text, begin, last, places)))
        begin = last + 1


def _items(text: str, begin: int, end: int, places: _Rows) -> Iterator[Number | Word]:
    """Numbers and words with blanks between."""
    for found in _TOKEN.finditer(text, begin, end):
        token, start = found.group(), found.start()
        if token[0] in _NUMBER_BEGINS:
            yield places.number(token, start)
        else:
            yield places.word(token, start)


def _words(text: str, begin: int, end: int, places: _Rows) -> Iterator[Word]:
    """The units between their brackets."""
    for found in _UNIT.finditer(text, begin, end):
        yield places.word(found.group(), found.start())


def _time(match: re.Match[str], places: _Rows) -> Time:
    text, (begin, end) = match.string, match.span(5)
    inner = match.group(5)[1:-1].strip(" \t")
    if inner.endswith("%"):
        return Time((_percent(inner, text.index(inner, begin), places),), places.at(begin, end))
    return Time(tuple(_items(text, begin + 1, end - 1, places)), places.at(begin, end))


def _percent(text: str, start: int, places: _Rows) -> Percent:
    return Percent(text, float(text.rstrip("% \t")), places.at(start, start + len(text)))


def _options(match: re.Match[str], places: _Rows) -> Iterator[Option | None]:
    """The options; None where one has more than one number, which is a fault."""
    for found in _option_form().finditer(match.string, *match.span(8)):
        word, said = found.groups()
        option = places.word(word, found.start(1))
        if said is None:
            yield Option(option, None)
        elif said.endswith("%"):
            yield Option(option, _percent(said, found.start(2), places))
        else:
            items = [*_items(match.string, *found.span(2), places)]
            yield Option(option, items[0]) if len(items) == 1 else None
