"""Convert positions of the Language Server Protocol: lines from 0, columns in the units that client and
server have agreed on.
"""

from __future__ import annotations

from lsprotocol import types

from yarclang.source import SourceFile, Span

UTF8 = types.PositionEncodingKind.Utf8
UTF16 = types.PositionEncodingKind.Utf16
UTF32 = types.PositionEncodingKind.Utf32


def units_of(text: str, encoding: str) -> int:
    """Return the length of a text in the units in which client and server count columns."""
    if text.isascii() or encoding == UTF32:
        return len(text)
    if encoding == UTF8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text.encode("utf-16-le", "surrogatepass")) // 2


def position_of(source: SourceFile, line: int, column: int, encoding: str) -> types.Position:
    """Return the protocol's position of a line and column from 1. For a column after the line's end,
    return the end.
    """
    return position_in(source.line(line), line, column, encoding)


def position_in(text: str, line: int, column: int, encoding: str) -> types.Position:
    """Return the position of a column in a line with this text."""
    return types.Position(line - 1, units_of(text[: column - 1], encoding))


def range_of(source: SourceFile, span: Span, encoding: str) -> types.Range:
    """Convert a span of a text to the protocol's range."""
    return types.Range(
        position_of(source, span.line, span.column, encoding),
        position_of(source, span.end_line, span.end_column, encoding),
    )


def column_of(line: str, units: int, encoding: str) -> int:
    """Return the column (from 1) that is `units` units of the protocol after a line's beginning.

    If this is inside a character, return the character's column.
    """
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
    """Return line and column (from 1) of a protocol's position. For a position after the text's end,
    return the end.
    """
    lines = source.lines
    if position.line < 0:
        return 1, 1
    if position.line >= len(lines):
        # A text that ends with a line end has one more line, which is empty.
        return min(position.line, len(lines)) + 1, 1
    line = position.line + 1
    return line, column_of(source.line(line), position.character, encoding)


def span_of(source: SourceFile, range_: types.Range, encoding: str) -> Span:
    """Convert a protocol's range to a span of a text."""
    return Span(*place_of(source, range_.start, encoding), *place_of(source, range_.end, encoding))
