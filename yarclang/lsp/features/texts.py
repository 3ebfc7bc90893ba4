"""Opened, changed, saved and closed texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.lsp.documents import Document
from yarclang.lsp.feature import Feature

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


def _opened(server: Server, params: types.DidOpenTextDocumentParams) -> None:
    item = params.text_document
    server.opened(Document(item.uri, item.version, item.text))


def _changed(server: Server, params: types.DidChangeTextDocumentParams) -> None:
    server.edited(params)


def _closed(server: Server, params: types.DidCloseTextDocumentParams) -> None:
    server.closed(params.text_document.uri)


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_DID_OPEN: (_opened, None),
        types.TEXT_DOCUMENT_DID_CHANGE: (_changed, None),
        types.TEXT_DOCUMENT_DID_CLOSE: (_closed, None),
    }
)
