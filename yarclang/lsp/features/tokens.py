"""Semantic tokens: the kind of each word."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.tints import tints
from yarclang.lsp.documents import Document
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, units_of

if TYPE_CHECKING:
    from yarclang.lsp.server import Server

_TYPES = {
    "comment": "comment",
    "string": "string",
    "number": "number",
    "index": "label",
    "command": "function",
    "keyword": "keyword",
    "operator": "operator",
    "frame": "class",
    "variable": "variable",
    "joints": "enumMember",
    "signal": "property",
    "sub": "method",
    "module": "namespace",
    "parameter": "parameter",
    "unit": "type",
    "function": "macro",
    "constant": "enum",
    "pose": "enumMember",
}
"""For each kind of word in yarclang.assist, the name that editors' themes use."""

_NAMES = list(_TYPES.values())
_NUMBERS = {tint: number for number, tint in enumerate(_TYPES)}
_DECLARES = 1


async def _whole(server: Server, params: types.SemanticTokensParams) -> types.SemanticTokens | None:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_program:
        return None
    found: types.SemanticTokens = await server.answer(document.uri, _tokens, server, document, 1, None)
    return found


async def _part(server: Server, params: types.SemanticTokensRangeParams) -> types.SemanticTokens | None:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_program:
        return None
    first, _ = place_of(document.source, params.range.start, server.encoding)
    last, _ = place_of(document.source, params.range.end, server.encoding)
    found: types.SemanticTokens = await server.answer(document.uri, _tokens, server, document, first, last)
    return found


def _tokens(server: Server, document: Document, first: int, last: int | None) -> types.SemanticTokens:
    """Return five numbers for each word, as the protocol requires: line and column relative to the previous
    word, length, kind, and 1 for a declaration.
    """
    data: list[int] = []
    line = character = 0
    text, read = "", 0
    for tint in tints(document.sketch, first, last):
        if tint.line != read:
            text, read = document.source.line(tint.line), tint.line
        start, end = (units_of(text[: at - 1], server.encoding) for at in (tint.start, tint.end))
        same = tint.line - 1 == line
        data += (
            tint.line - 1 - line,
            start - (character if same else 0),
            end - start,
            _NUMBERS[tint.tint],
            _DECLARES if tint.declares else 0,
        )
        line, character = tint.line - 1, start
    return types.SemanticTokens(data)


_LEGEND = types.SemanticTokensLegend(_NAMES, ["declaration"])

FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: (_whole, _LEGEND),
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_RANGE: (_part, None),
    }
)
