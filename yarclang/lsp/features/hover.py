"""Hover: what is known of the place under the mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.hover import hover_at
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, range_of

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


async def _hover(server: Server, params: types.HoverParams) -> types.Hover | None:
    view = server.view(params.text_document.uri)
    if view is None or not server.documents[params.text_document.uri].is_program:
        return None
    source = view.sketch.source
    found = await server.answer(hover_at, view, *place_of(source, params.position, server.encoding))
    if found is None:
        return None
    content = types.MarkupContent(types.MarkupKind.Markdown, found.text)
    return types.Hover(content, range_of(source, found.span, server.encoding))


FEATURE = Feature({types.TEXT_DOCUMENT_HOVER: (_hover, types.HoverOptions())})
