"""A language server in a separate process, and a client that talks to it."""

import asyncio
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from lsprotocol import types
from pytest_lsp import LanguageClient, make_test_lsp_client

COMMAND = (sys.executable, "-c", "from yarclang.cli.yarc import main; main()", "lsp")
LONGEST = 30.0


def capabilities(
    *, pull: bool, refresh: bool = True, pages: bool = False, **more: Any
) -> types.ClientCapabilities:
    return types.ClientCapabilities(
        text_document=types.TextDocumentClientCapabilities(
            publish_diagnostics=types.PublishDiagnosticsClientCapabilities(
                related_information=True, code_description_support=pages
            ),
            diagnostic=types.DiagnosticClientCapabilities() if pull else None,
            hover=types.HoverClientCapabilities(content_format=[types.MarkupKind.Markdown]),
            completion=types.CompletionClientCapabilities(
                completion_item=types.ClientCompletionItemOptions(
                    snippet_support=True, documentation_format=[types.MarkupKind.Markdown]
                )
            ),
            **more,
        ),
        workspace=types.WorkspaceClientCapabilities(
            diagnostics=types.DiagnosticWorkspaceClientCapabilities(refresh_support=refresh)
        ),
    )


class Editor:
    """The actions of a person in an editor, as short methods."""

    def __init__(self, client: LanguageClient) -> None:
        self.client = client
        self.versions: dict[str, int] = {}
        self.refreshed = asyncio.Event()
        client.protocol.fm.features[types.WORKSPACE_DIAGNOSTIC_REFRESH] = self._refresh

    def _refresh(self, params: object) -> None:
        self.refreshed.set()

    def open(self, path: Path, text: str) -> types.TextDocumentIdentifier:
        uri = path.absolute().as_uri()
        self.versions[uri] = 1
        item = types.TextDocumentItem(uri, "yarc", 1, text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(item))
        return types.TextDocumentIdentifier(uri)

    def write(self, document: types.TextDocumentIdentifier, text: str) -> None:
        self.change(document, [types.TextDocumentContentChangeWholeDocument(text=text)])

    def change(
        self, document: types.TextDocumentIdentifier, changes: list[types.TextDocumentContentChangeEvent]
    ) -> None:
        self.versions[document.uri] += 1
        identifier = types.VersionedTextDocumentIdentifier(self.versions[document.uri], document.uri)
        self.client.text_document_did_change(types.DidChangeTextDocumentParams(identifier, changes))

    async def pulled(self, document: types.TextDocumentIdentifier) -> list[types.Diagnostic]:
        report = await self.client.text_document_diagnostic_async(types.DocumentDiagnosticParams(document))
        return list(report.items)

    async def until(
        self, document: types.TextDocumentIdentifier, wanted: Callable[[list[types.Diagnostic]], bool]
    ) -> list[types.Diagnostic]:
        """Wait until the findings of a text meet a condition, and return these findings."""
        while not wanted(found := list(self.client.diagnostics.get(document.uri, []))):
            await self.client.wait_for_notification(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        return found


@asynccontextmanager
async def editor(client_capabilities: types.ClientCapabilities) -> AsyncIterator[Editor]:
    client = make_test_lsp_client()
    one = Editor(client)
    await client.start_io(*COMMAND)
    try:
        await client.initialize_session(
            types.InitializeParams(capabilities=client_capabilities, workspace_folders=None)
        )
        yield one
        await client.shutdown_session()
    except BaseException:
        if client._server.returncode is None:
            client._server.kill()
        raise
    finally:
        await client.stop()


def run(work: Callable[[Editor], Awaitable[None]], client_capabilities: types.ClientCapabilities) -> None:
    """Run `work` with a separate server. If the server doesn't answer in time, the test fails."""

    async def whole() -> None:
        async with asyncio.timeout(LONGEST), editor(client_capabilities) as one:
            await work(one)

    asyncio.run(whole())
