"""Send the findings of a text to the client. The client pulls them, or they are pushed to clients that don't
pull; never both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.findings.finding import page
from yarclang.lint.registry import everything
from yarclang.lsp.analyses import Analysis
from yarclang.lsp.feature import Feature
from yarclang.lsp.translation import diagnostic_of, expect

if TYPE_CHECKING:
    from yarclang.lsp.server import Server

PATIENCE = 0.3
"""Longest time that a client's request waits for planned motions [s].

After that, the client gets the results without planning, and is asked to request again.
"""


def _asks(server: Server) -> bool:
    """Return True if the client pulls findings."""
    text = server.client_capabilities.text_document
    return text is not None and text.diagnostic is not None


def _can_ask_again(server: Server) -> bool:
    workspace = server.client_capabilities.workspace
    refresh = workspace.diagnostics if workspace else None
    return bool(refresh and refresh.refresh_support)


def _items(server: Server, analysis: Analysis) -> list[types.Diagnostic]:
    shown = analysis.shown
    expect(len(shown))
    items = [diagnostic_of(analysis.document, one, server.encoding) for one in shown]
    if _shows_pages(server):
        for item in items:
            item.code_description = _page(server, str(item.code))
    return items


def _shows_pages(server: Server) -> bool:
    """Return True if the client can show a link from a finding's code to its page."""
    text = server.client_capabilities.text_document
    shown = text.publish_diagnostics if text else None
    return bool(shown and shown.code_description_support)


def _page(server: Server, code: str) -> types.CodeDescription:
    """Return the link to a code's page. The page is written when it is first needed."""
    path = server.files / f"{code}.md"
    if not path.exists():
        path.write_text(page(everything()[code]), encoding="utf-8")
    return types.CodeDescription(path.as_uri())


def _name(analysis: Analysis) -> str:
    """Return an identifier for the findings of an analysis."""
    stage = 2 if analysis.is_whole else int(analysis.is_planned)
    return f"{analysis.document.version}.{analysis.generation}.{stage}"


async def _asked(
    server: Server, params: types.DocumentDiagnosticParams
) -> types.RelatedFullDocumentDiagnosticReport | types.RelatedUnchangedDocumentDiagnosticReport:
    patience = PATIENCE if _can_ask_again(server) else None
    uri = params.text_document.uri
    if patience is None:
        analysis = await server.analyses.whole(uri, None)
    else:
        analysis = await server.analyses.most(uri, patience)
    if analysis is None:
        return types.RelatedFullDocumentDiagnosticReport(items=[])
    if not analysis.is_whole:
        server.owed.add(params.text_document.uri)
    name = _name(analysis)
    if params.previous_result_id == name:
        return types.RelatedUnchangedDocumentDiagnosticReport(result_id=name)
    return types.RelatedFullDocumentDiagnosticReport(items=_items(server, analysis), result_id=name)


def _arrived(server: Server, analysis: Analysis) -> None:
    """Push the findings. If the client pulls, ask it to request them again."""
    uri = analysis.document.uri
    if analysis.repeats:
        server.owed.discard(uri)
    elif not _asks(server):
        server.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri, _items(server, analysis), version=analysis.document.version)
        )
    elif analysis.is_whole and uri in server.owed:
        server.owed.discard(uri)
        server.workspace_diagnostic_refresh(None)


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_DIAGNOSTIC: (
            _asked,
            types.DiagnosticOptions(
                inter_file_dependencies=True, workspace_diagnostics=False, identifier="yarc"
            ),
        )
    },
    listens=_arrived,
)
