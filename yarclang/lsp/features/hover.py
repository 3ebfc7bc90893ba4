"""Hover: the explanation of the text under the mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.hover import hover_at
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, range_of
from yarclang.lsp.translation import markup

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


async def _hover(server: Server, params: types.HoverParams) -> types.Hover | None:
    uri = params.text_document.uri
    view = server.program_view(uri)
    if view is None:
        return None
    source = view.sketch.source
    found = await server.answer(uri, hover_at, view, *place_of(source, params.position, server.encoding))
    if found is None:
        return None
    text = server.client_capabilities.text_document
    content = markup(found.text, text.hover.content_format if text and text.hover else None)
    return types.Hover(content, range_of(source, found.span, server.encoding))


FEATURE = Feature({types.TEXT_DOCUMENT_HOVER: (_hover, types.HoverOptions())})
