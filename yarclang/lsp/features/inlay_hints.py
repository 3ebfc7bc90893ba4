"""Inlay hints: the shortest time of a motion, and its share of the limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.hints import Hint, hints_in
from yarclang.assist.view import View
from yarclang.lsp.analyses import Analysis
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, position_of

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


async def _hints(server: Server, params: types.InlayHintParams) -> list[types.InlayHint]:
    uri = params.text_document.uri
    view = server.program_view(uri)
    if view is None:
        return []
    source = view.sketch.source
    first, _ = place_of(source, params.range.start, server.encoding)
    last, _ = place_of(source, params.range.end, server.encoding)
    found = await server.answer(uri, _listed, server, view, first, last)
    return [
        types.InlayHint(
            position=position_of(source, one.line, one.column, server.encoding),
            label=one.text,
            padding_left=True,
            tooltip=types.MarkupContent(types.MarkupKind.Markdown, one.tooltip),
        )
        for one in found
    ]


def _listed(server: Server, view: View, first: int, last: int) -> list[Hint]:
    return list(hints_in(view, first, last, server.shortest_times))


def _arrived(server: Server, analysis: Analysis) -> None:
    """Ask a client to request its hints again, since motions are planned now."""
    workspace = server.client_capabilities.workspace
    refresh = workspace.inlay_hint if workspace else None
    if analysis.is_whole and refresh and refresh.refresh_support:
        server.workspace_inlay_hint_refresh(None)


FEATURE = Feature({types.TEXT_DOCUMENT_INLAY_HINT: (_hints, types.InlayHintOptions())}, listens=_arrived)
