"""Links from names of files to the files, and growing selections around a place."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.links import links
from yarclang.assist.selection import around
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, range_of
from yarclang.lsp.translation import uri_of

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


def _links(server: Server, params: types.DocumentLinkParams) -> list[types.DocumentLink]:
    view, document = (
        server.program_view(params.text_document.uri),
        server.documents.get(params.text_document.uri),
    )
    if view is None or document is None:
        return []
    return [
        types.DocumentLink(
            range=range_of(view.sketch.source, one.span, server.encoding),
            target=uri_of(str(one.path)),
            tooltip=f"open {one.what}",
        )
        for one in links(view, document.folder)
    ]


def _selections(server: Server, params: types.SelectionRangeParams) -> list[types.SelectionRange] | None:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_program:
        return None
    found = []
    for position in params.positions:
        made: types.SelectionRange | None = None
        for span in reversed(around(document.sketch, *place_of(document.source, position, server.encoding))):
            made = types.SelectionRange(range_of(document.source, span, server.encoding), made)
        assert made is not None  # the whole text contains each place
        found.append(made)
    return found


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_DOCUMENT_LINK: (_links, types.DocumentLinkOptions(resolve_provider=False)),
        types.TEXT_DOCUMENT_SELECTION_RANGE: (_selections, types.SelectionRangeOptions()),
    }
)
