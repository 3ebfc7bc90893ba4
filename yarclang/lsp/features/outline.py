"""Outline and folding of a file, and names in all files of the workspace."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.outline import Entry, folds, outline
from yarclang.lsp.documents import Document
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import range_of
from yarclang.source import SourceFile

if TYPE_CHECKING:
    from yarclang.lsp.server import Server

_KINDS = {
    "frame": types.SymbolKind.Class,
    "number": types.SymbolKind.Constant,
    "table": types.SymbolKind.Array,
    "function": types.SymbolKind.Function,
    "joints": types.SymbolKind.EnumMember,
    "register": types.SymbolKind.Variable,
    "pose": types.SymbolKind.EnumMember,
    "input": types.SymbolKind.Property,
    "output": types.SymbolKind.Property,
    "sub": types.SymbolKind.Function,
    "module": types.SymbolKind.Module,
    "block": types.SymbolKind.Namespace,
    "command": types.SymbolKind.Event,
}


async def _document(server: Server, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_program:
        return []
    return list(await server.answer(document.uri, _symbols, server, document))


def _symbols(server: Server, document: Document) -> list[types.DocumentSymbol]:
    return [_symbol(server, document.source, one) for one in outline(document.sketch)]


def _symbol(server: Server, source: SourceFile, entry: Entry) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        name=entry.name,
        detail=entry.detail,
        kind=_KINDS[entry.kind],
        range=range_of(source, entry.span, server.encoding),
        selection_range=range_of(source, entry.name_span, server.encoding),
        children=[_symbol(server, source, one) for one in entry.children] or None,
    )


async def _workspace(server: Server, params: types.WorkspaceSymbolParams) -> list[types.WorkspaceSymbol]:
    sketches = await server.answer("", server.modules.everywhere, server.roots())
    query = params.query.upper()
    return [
        types.WorkspaceSymbol(
            location=types.Location(
                server.uri_of(sketch.source.name), range_of(sketch.source, one.name_span, server.encoding)
            ),
            name=one.name,
            kind=_KINDS[one.kind],
            container_name=sketch.source.name.rpartition("/")[2],
        )
        for sketch in sketches
        for one in _declared(outline(sketch))
        if _fits(query, one.name.upper())
    ]


def _declared(entries: Iterable[Entry]) -> Iterator[Entry]:
    for one in entries:
        if one.kind not in {"command", "block"}:
            yield one
        yield from _declared(one.children)


def _fits(query: str, name: str) -> bool:
    """Return True if a name contains the letters of a query in the same order."""
    rest = iter(name)
    return all(letter in rest for letter in query)


async def _folding(server: Server, params: types.FoldingRangeParams) -> list[types.FoldingRange]:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_program:
        return []
    return [
        types.FoldingRange(
            start_line=one.first - 1,
            end_line=one.last - 1,
            kind=types.FoldingRangeKind.Comment if one.is_comment else types.FoldingRangeKind.Region,
        )
        for one in await server.answer(document.uri, lambda: folds(document.sketch))
    ]


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: (_document, types.DocumentSymbolOptions(label="YARC")),
        types.WORKSPACE_SYMBOL: (_workspace, types.WorkspaceSymbolOptions()),
        types.TEXT_DOCUMENT_FOLDING_RANGE: (_folding, types.FoldingRangeOptions()),
    }
)
