"""Places in a text as the protocol counts them: lines from 0, columns in the units that client and server agreed on."""

from __future__ import annotations

from lsprotocol import types

from yarclang.source import SourceFile, Span

UTF8 = types.PositionEncodingKind.Utf8
UTF16 = types.PositionEncodingKind.Utf16
UTF32 = types.PositionEncodingKind.Utf32


def units_of(text: str, encoding: str) -> int:
    """How many units a text has."""
    if text.isascii() or encoding == UTF32:
        return len(text)
    if encoding == UTF8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text.encode("utf-16-le", "surrogatepass")) // 2


def position_of(source: SourceFile, line: int, column: int, encoding: str) -> types.Position:
    """The position of a line and column from 1; behind a line's end its end is meant."""
    return position_in(source.line(line), line, column, encoding)


def position_in(text: str, line: int, column: int, encoding: str) -> types.Position:
    """The same where the line's text is at hand."""
    return types.Position(line - 1, units_of(text[: column - 1], encoding))


def range_of(source: SourceFile, span: Span, encoding: str) -> types.Range:
    """The range of a span."""
    return types.Range(
        position_of(source, span.line, span.column, encoding),
        position_of(source, span.end_line, span.end_column, encoding),
    )


def column_of(line: str, units: int, encoding: str) -> int:
    """The column from 1 that lies `units` units behind a line's beginning; in the middle of a character that character's."""
    if units <= 0:
        return 1
    if line.isascii() or encoding == UTF32:
        return min(units, len(line)) + 1
    passed = 0
    for number, character in enumerate(line):
        passed += units_of(character, encoding)
        if passed > units:
            return number + 1
        if passed == units:
            return number + 2
    return len(line) + 1


def place_of(source: SourceFile, position: types.Position, encoding: str) -> tuple[int, int]:
    """Line and column from 1 of a position; beyond the end of the text its end is meant."""
    lines = source.lines
    if position.line < 0:
        return 1, 1
    if position.line >= len(lines):
        # a text that ends with a line end has one more line, which is empty
        return min(position.line, len(lines)) + 1, 1
    line = position.line + 1
    return line, column_of(source.line(line), position.character, encoding)


def span_of(source: SourceFile, range_: types.Range, encoding: str) -> Span:
    """The span of a range."""
    return Span(*place_of(source, range_.start, encoding), *place_of(source, range_.end, encoding))
