"""Opened, changed, saved and closed texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.lsp.documents import Document
from yarclang.lsp.feature import Feature

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


def _initialized(server: Server, params: types.InitializeParams) -> None:
    """Store the settings that the client sends with its first message."""
    given = params.initialization_options
    server.settings = dict(given) if isinstance(given, dict) else {}


def _ready(server: Server, params: types.InitializedParams) -> None:  # noqa: ARG001  (the protocol passes it)
    """Ask the client to report changes of files by other programs."""
    workspace = server.client_capabilities.workspace
    watches = workspace.did_change_watched_files if workspace else None
    if watches is None or not watches.dynamic_registration:
        return
    options = types.DidChangeWatchedFilesRegistrationOptions(
        [types.FileSystemWatcher("**/*.{yarc,toml,urdf,srdf,csv}")]
    )
    registration = types.Registration("files", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
    server.client_register_capability(types.RegistrationParams([registration]))


def _opened(server: Server, params: types.DidOpenTextDocumentParams) -> None:
    item = params.text_document
    server.opened(Document(item.uri, item.version, item.text))


def _changed(server: Server, params: types.DidChangeTextDocumentParams) -> None:
    server.edited(params)


def _closed(server: Server, params: types.DidCloseTextDocumentParams) -> None:
    server.closed(params.text_document.uri)


def _saved(server: Server, params: types.DidSaveTextDocumentParams) -> None:
    """Check the texts that depend on a saved file."""
    server.touched(params.text_document.uri)


def _watched(server: Server, params: types.DidChangeWatchedFilesParams) -> None:
    """Check the texts that depend on files that other programs have changed."""
    for one in params.changes:
        server.touched(one.uri)


FEATURE = Feature(
    {
        types.INITIALIZE: (_initialized, None),
        types.INITIALIZED: (_ready, None),
        types.TEXT_DOCUMENT_DID_OPEN: (_opened, None),
        types.TEXT_DOCUMENT_DID_CHANGE: (_changed, None),
        types.TEXT_DOCUMENT_DID_SAVE: (_saved, None),
        types.TEXT_DOCUMENT_DID_CLOSE: (_closed, None),
        types.WORKSPACE_DID_CHANGE_WATCHED_FILES: (_watched, None),
    }
)
