"""Find the kind of each word of a text, for editors that colour it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from yarclang.assist.lexemes import Lexeme, lexemes_of
from yarclang.assist.sketch import Sketch
from yarclang.syntax.words import CONSTANTS, DECLARATIONS, FUNCTIONS, OPERATORS, OPTIONS, RATES, STATES
from yarclang.units import UNITS

Tint = Literal[
    "comment",
    "string",
    "number",
    "index",
    "command",
    "keyword",
    "operator",
    "frame",
    "variable",
    "joints",
    "signal",
    "sub",
    "module",
    "parameter",
    "unit",
    "function",
    "constant",
    "pose",
]
_OF_SYMBOL: dict[str, Tint] = {
    "frame": "frame",
    "number": "variable",
    "table": "variable",
    "function": "function",
    "joints": "joints",
    "register": "variable",
    "pose": "pose",
    "input": "signal",
    "output": "signal",
    "sub": "sub",
    "module": "module",
    "parameter": "parameter",
}


@dataclass(frozen=True, slots=True)
class Tinted:
    """A range of a line, with the kind of word for syntax colours.

    Attributes:
        line: from 1.
        start: first column, from 1.
        end: column after the last one.
        tint: kind of the word.
        declares: True if a name is declared here.
    """

    line: int
    start: int
    end: int
    tint: Tint
    declares: bool = False


def tints(sketch: Sketch, first: int = 1, last: int | None = None) -> Iterator[Tinted]:
    """Yield the words of the lines `first` to `last` with their kinds, for syntax colours; also in lines that
    can't be parsed.
    """
    named: dict[tuple[int, int], tuple[Tint, bool]] = {}
    for symbol in sketch.names.symbols:
        named[symbol.span.line, symbol.span.column] = _OF_SYMBOL[symbol.kind], True
    for use in sketch.names.uses:
        tint: Tint = "frame" if use.is_frame else "joints"
        if use.symbol is not None:
            tint = _OF_SYMBOL[use.symbol.kind]
        elif use.module:
            tint = "frame" if use.is_frame else "sub"
        named[use.span.line, use.span.column] = tint, False
    goes_on = False
    count = len(sketch.source.lines)
    begin = sketch.begin_of(first) if first > 1 else 1
    lexemes_of.expect(count)
    for number in range(begin, min(last or count, count) + 1):
        pieces = lexemes_of(sketch.source.line(number))
        code = [one for one in pieces if one.kind != "comment"]
        if number >= first:
            yield from _of_line(number, pieces, named, goes_on)
        if code:
            goes_on = code[-1].text == ";"


def _of_line(
    line: int, pieces: tuple[Lexeme, ...], named: dict[tuple[int, int], tuple[Tint, bool]], goes_on: bool
) -> Iterator[Tinted]:
    head_at = 1 if pieces and pieces[0].kind == "index" else 0
    for number, piece in enumerate(pieces):
        tint: Tint | None
        if piece.kind in {"frame", "word", "open_frame"}:
            found = list(_names(line, piece, named))
            if found:
                yield from found
                continue
        is_called = number + 1 < len(pieces) and pieces[number + 1].text == "("
        tint = _plain(piece, is_head=number == head_at and not goes_on, is_called=is_called)
        if tint is not None:
            yield Tinted(line, piece.start, piece.end, tint)


def _names(line: int, piece: Lexeme, named: dict[tuple[int, int], tuple[Tint, bool]]) -> Iterator[Tinted]:
    """Yield the names in a token: `PALLET.GRID` has two."""
    start = piece.start
    for part in piece.text.split("."):
        inner = part.strip("{} \t")
        at = start + part.find(inner) if inner else start
        found = named.get((line, at))
        if found is not None and inner:
            yield Tinted(line, at, at + len(inner), *found)
        start += len(part) + 1


def _plain(piece: Lexeme, *, is_head: bool, is_called: bool) -> Tint | None:
    """Return the kind of a word that isn't a declared name. `MIN` is a function before a bracket, and
    elsewhere a constant (the shortest motion time). It is never the unit of minutes.
    """
    match piece.kind:
        case "comment" | "string" | "number" | "index":
            return piece.kind
        case "frame" | "open_frame":
            return "frame"
        case "mark":
            return (
                "operator"
                if piece.text in {"=", "<", ">", "<=", ">=", "<>", "+", "-", "*", "/", "%", "**"}
                else None
            )
    name = piece.name
    if is_head:
        return "keyword" if name in DECLARATIONS else "command"
    if piece.text.lower() in UNITS and name not in {"MIN"}:
        return "unit"
    if name in OPTIONS or name in RATES or name in OPERATORS:
        return "keyword"
    if name in FUNCTIONS and (is_called or name != "MIN"):
        return "function"
    if name in STATES or name in CONSTANTS or name in {"MIN", "V"}:
        return "constant"
    return "variable"
