"""Formatting of the whole text or of some lines, in the same way as `yarc fmt`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.changes import formatted
from yarclang.diagnostics import Edit
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of
from yarclang.lsp.translation import text_edits
from yarclang.source import SourceFile, Span
from yarclang.syntax.form import usual_form

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


def _whole(server: Server, params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
    document = server.documents.get(params.text_document.uri)
    edits = formatted(document.source) if document and document.is_program else None
    return text_edits(document.source, edits, server.encoding) if document and edits is not None else None


def _part(server: Server, params: types.DocumentRangeFormattingParams) -> list[types.TextEdit] | None:
    document = server.documents.get(params.text_document.uri)
    edits = formatted(document.source) if document and document.is_program else None
    if document is None or edits is None:
        return None
    first, _ = place_of(document.source, params.range.start, server.encoding)
    last, column = place_of(document.source, params.range.end, server.encoding)
    last -= column == 1 and last > first  # an end at column 1 doesn't include this line
    inside = [
        one
        for one in edits
        if one.span.line >= first and _last_line(one.span.end_line, one.span.end_column) <= last
    ]
    return text_edits(document.source, inside, server.encoding)


def _typed(server: Server, params: types.DocumentOnTypeFormattingParams) -> list[types.TextEdit] | None:
    """Format the line that the user has just ended. The rest of the text must not change while the user
    types.
    """
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_program:
        return None
    line = params.position.line  # number (from 1) of the ended line, and (from 0) of the new one
    if not 1 <= line <= len(document.source.lines):
        return None
    text = document.source.line(line)
    usual = usual_form(SourceFile("line", text)).value
    if not text.strip() or usual is None:
        return None
    form = text[: len(text) - len(text.lstrip())] + usual.strip()
    if form == text:
        return None
    span = Span.on_line(line, 1, len(text) + 1)
    return text_edits(document.source, (Edit(span, form),), server.encoding)


def _last_line(line: int, column: int) -> int:
    """Return the last line that an edit changes. If the range of the edit ends at the beginning of a line,
    this is the line before.
    """
    return line - 1 if column == 1 else line


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_FORMATTING: (_whole, types.DocumentFormattingOptions()),
        types.TEXT_DOCUMENT_RANGE_FORMATTING: (_part, types.DocumentRangeFormattingOptions()),
        types.TEXT_DOCUMENT_ON_TYPE_FORMATTING: (
            _typed,
            types.DocumentOnTypeFormattingOptions(first_trigger_character="\n"),
        ),
    }
)
