"""Parse the most common statements quickly: statements of one line, without expressions and texts in quotes,
by a single regular expression.

    P0001 MOVEJ_RPY_LSPB {TCP} 0.00 1174.40 1176.00 0.00 0.00 0.00 [20] (mm,deg,s) {B} BLEND 5 ! to the part

Lark takes three times as long for the same line, and 30 ms to import. The expression consists of the
grammar's own terminals. A line that doesn't match is parsed by the grammar; a line that matches gives the
same result as the grammar, to the last column (tests/syntax/test_plain.py).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache, lru_cache
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
    """Return the grammar's terminals that are regular expressions, by their names."""
    return {
        name: f"(?i:{pattern})" if flag else f"(?:{pattern})"
        for name, pattern, flag in _TERMINAL.findall(GRAMMAR.read_text(encoding="utf-8"))
    }


@cache
def _form() -> re.Pattern[str]:
    """Return the regular expression of a whole common statement.

    Each group matches in the same way as in the grammar's lexer, without backtracking. If anything else
    follows, the expression doesn't match.
    """
    said = terminals()
    index, frame, numbers, percent, option = (
        said[name] for name in ("INDEX", "FRAME", "NUMBERS", "PERCENT", "OPTION")
    )
    others = "|".join(
        said[name] for name in ("CALL", "SUB", "LET", "FUNC", "SETS", "IF", "WHENS", "WAITS", "LONE")
    )
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
    """Return the regular expression of one option and its argument."""
    said = terminals()
    argument = f"{said['PERCENT']}|{said['NUMBERS']}|(?!{said['OPTION']}){said['WORD']}"
    return re.compile(rf"({said['OPTION']})[ \t]*+(?>({argument}))?+")


def plain_statement(text: str) -> Statement | None:
    """Parse a text by the regular expression for common statements. Return None if only the grammar can parse
    it.

    `line` of the statement is 0 until the caller sets it.
    """
    match = None if "\n" in text else _form().match(text)
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
        _word(name, match.start(2)),
        FrameName(moving, _place(match, 3)) if moving else None,
        tuple(_waypoints(text, *match.span(4))) if values else (),
        None,
        _time(match) if time else None,
        Units(tuple(_words(text, *match.span(6))), _place(match, 6)) if units else None,
        FrameName(base, _place(match, 7)) if base else None,
        named,  # type: ignore[arg-type]
        comments_of(text),
    )


_SHORT = 5


def _place(match: re.Match[str], group: int) -> Place:
    return _at(*match.span(group))


@lru_cache(maxsize=1 << 16)
def _at(begin: int, end: int) -> Place:
    """Return the place of the characters from `begin` to `end` (exclusive). Equal places in the lines of a
    long program are one object.
    """
    return Place(0, begin + 1, end + 1)


@lru_cache(maxsize=1 << 14)
def _word(token: str, begin: int) -> Word:
    return Word(token, _at(begin, begin + len(token)))


def _number(token: str, begin: int) -> Number:
    return Number(token, float(token), _at(begin, begin + len(token)))


_short_number = lru_cache(maxsize=1 << 14)(_number)
"""Short numbers occur many times, so equal ones share one object."""


def _waypoints(text: str, begin: int, end: int) -> Iterator[WayPoint]:
    """Yield the waypoints between semicolons."""
    while begin < end:
        found = text.find(";", begin, end)
        last = end if found < 0 else found
        yield WayPoint(tuple(_items(text, begin, last)))
        begin = last + 1


def _items(text: str, begin: int, end: int) -> Iterator[Number | Word]:
    """Yield the numbers and words between blanks."""
    for found in _TOKEN.finditer(text, begin, end):
        token, start = found.group(), found.start()
        if token[0] not in _NUMBER_BEGINS:
            yield _word(token, start)
        else:
            yield _short_number(token, start) if len(token) <= _SHORT else _number(token, start)


def _words(text: str, begin: int, end: int) -> Iterator[Word]:
    """Yield the units between their brackets."""
    for found in _UNIT.finditer(text, begin, end):
        yield _word(found.group(), found.start())


def _time(match: re.Match[str]) -> Time:
    text, (begin, end) = match.string, match.span(5)
    inner = match.group(5)[1:-1].strip(" \t")
    if inner.endswith("%"):
        return Time((_percent(inner, text.index(inner, begin)),), _at(begin, end))
    return Time(tuple(_items(text, begin + 1, end - 1)), _at(begin, end))


def _percent(text: str, begin: int) -> Percent:
    return Percent(text, float(text.rstrip("% \t")), _at(begin, begin + len(text)))


def _options(match: re.Match[str]) -> Iterator[Option | None]:
    """Yield the options; None for an option with more than one number, which is a fault."""
    for found in _option_form().finditer(match.string, *match.span(8)):
        word, said = found.groups()
        option = _word(word, found.start(1))
        if said is None:
            yield Option(option, None)
        elif said.endswith("%"):
            yield Option(option, _percent(said, found.start(2)))
        else:
            items = [*_items(match.string, *found.span(2))]
            yield Option(option, items[0]) if len(items) == 1 else None
