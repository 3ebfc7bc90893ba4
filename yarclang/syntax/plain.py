"""Statements as most lines have them, read by one regular expression: no expression, no text in quotes, one line.

    P0001 MOVEJ_RPY_LSPB {TCP} 0.00 1174.40 1176.00 0.00 0.00 0.00 [20] (mm,deg,s) {B} BLEND 5 ! to the part

Lark reads the same statement in six times the time, and has to be imported first. The expression is put together of the grammar's own terminals; what it doesn't
match is left to the grammar, and what it matches is to the last column what the grammar gives (tests/syntax/test_plain.py).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

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
    """The statement of a text of one line; `line` is 0 until the caller sets it. None where it takes the grammar to read it."""
    match = _form().match(text)
    if match is None:
        return None
    index, name, moving, values, time, units, base, options = match.groups()
    named = tuple(_options(match)) if options else ()
    if None in named:
        return None
    return Statement(
        0,
        1,
        Word(index, _place(match, 1)) if index else None,
        Word(name, _place(match, 2)),
        FrameName(moving, _place(match, 3)) if moving else None,
        tuple(_waypoints(text, *match.span(4))) if values else (),
        None,
        _time(match) if time else None,
        Units(tuple(_words(text, *match.span(6))), _place(match, 6)) if units else None,
        FrameName(base, _place(match, 7)) if base else None,
        named,  # type: ignore[arg-type]
        comments_of(text),
    )


def _place(match: re.Match[str], group: int) -> Place:
    start, end = match.span(group)
    return Place(0, start + 1, end + 1)


def _waypoints(text: str, begin: int, end: int) -> Iterator[WayPoint]:
    """The way-points between semicolons."""
    while begin < end:
        found = text.find(";", begin, end)
        last = end if found < 0 else found
        yield WayPoint(tuple(_items(text, begin, last)))
        begin = last + 1


def _items(text: str, begin: int, end: int) -> Iterator[Number | Word]:
    """Numbers and words with blanks between."""
    for found in _TOKEN.finditer(text, begin, end):
        token, start = found.group(), found.start() + 1
        place = Place(0, start, start + len(token))
        yield Number(token, float(token), place) if token[0] in _NUMBER_BEGINS else Word(token, place)


def _words(text: str, begin: int, end: int) -> Iterator[Word]:
    """The units between their brackets."""
    for found in _UNIT.finditer(text, begin, end):
        yield Word(found.group(), Place(0, found.start() + 1, found.end() + 1))


def _time(match: re.Match[str]) -> Time:
    text, (begin, end) = match.string, match.span(5)
    inner = match.group(5)[1:-1].strip(" \t")
    if inner.endswith("%"):
        start = text.index(inner, begin) + 1
        return Time((_percent(inner, start),), Place(0, begin + 1, end + 1))
    return Time(tuple(_items(text, begin + 1, end - 1)), Place(0, begin + 1, end + 1))


def _percent(text: str, start: int) -> Percent:
    return Percent(text, float(text.rstrip("% \t")), Place(0, start, start + len(text)))


def _options(match: re.Match[str]) -> Iterator[Option | None]:
    """The options; None where one has more than one number, which is a fault."""
    for found in _option_form().finditer(match.string, *match.span(8)):
        word, said = found.groups()
        option = Word(word, _place(found, 1))
        if said is None:
            yield Option(option, None)
        elif said.endswith("%"):
            yield Option(option, _percent(said, found.start(2) + 1))
        else:
            items = [*_items(match.string, *found.span(2))]
            yield Option(option, items[0]) if len(items) == 1 else None
