"""Quick fixes of findings, and actions on a whole text: renumber, apply all safe fixes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from lsprotocol import types

from yarclang.assist.changes import changes_to, formatted
from yarclang.assist.repairs import Repair, repairs_of
from yarclang.diagnostics import Diagnostic, Fix
from yarclang.lsp.analyses import Analysis
from yarclang.lsp.documents import Document
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import span_of
from yarclang.lsp.translation import diagnostic_of, text_edits
from yarclang.pipeline.checking import Checked
from yarclang.pipeline.fixing import fixed, is_repair
from yarclang.source import SourceFile, Span

if TYPE_CHECKING:
    from yarclang.lsp.server import Server

FIX_ALL = types.CodeActionKind.SourceFixAll.value + ".yarc"
RENUMBER = types.CodeActionKind.Source.value + ".renumber.yarc"
_START, _STEP = 10, 10


async def _actions(server: Server, params: types.CodeActionParams) -> list[types.CodeAction]:
    uri = params.text_document.uri
    analysis = await server.analyses.whole(uri, 0.0)
    document = server.documents.get(uri)
    if analysis is None or document is None or analysis.document is not document:
        return []
    only = params.context.only
    actions: list[types.CodeAction] = []
    if _wanted(types.CodeActionKind.QuickFix.value, only):
        actions += _quick_fixes(server, document, analysis, params.range)
    if document.is_program:
        if _wanted(RENUMBER, only):
            actions += _renumber(server, document)
        if _wanted(FIX_ALL, only) and _fixable(document, analysis.checked):
            actions.append(_fix_all(uri))
            # A request for all kinds of actions must not wait for planning.
            if only is not None or (not _resolves(server) and analysis.is_whole):
                await _resolve(server, actions[-1])
            elif not _resolves(server):
                actions.pop()
    return [one for one in actions if one.edit is not None or one.data is not None]


def _wanted(kind: str, only: Any) -> bool:
    """Return True if an action's kind, or a kind that includes it, is requested."""
    names = [getattr(one, "value", one) for one in only or ()]
    return only is None or any(kind == one or kind.startswith(f"{one}.") or one == "" for one in names)


def _resolves(server: Server) -> bool:
    """Return True if the client can request the edit of an action later, when the user selects it."""
    text = server.client_capabilities.text_document
    support = text.code_action.resolve_support if text and text.code_action else None
    return support is not None and "edit" in support.properties


# Actions for findings.


def _quick_fixes(
    server: Server, document: Document, analysis: Analysis, range_: types.Range
) -> Iterator[types.CodeAction]:
    found = analysis.checked.diagnostics
    asked = span_of(document.source, range_, server.encoding)
    sketch = document.sketch if document.is_program else None
    seen: set[Fix] = set()
    for finding in found:
        if not _is_own(document, finding) or not _touches(finding.span, asked):
            continue
        for repair in repairs_of(document.source, sketch, finding, found):
            if repair.fix not in seen:
                seen.add(repair.fix)
                yield _quick_fix(server, document, repair)


def _is_own(document: Document, finding: Diagnostic) -> bool:
    return finding.source is not None and finding.source.name == document.source.name


def _touches(span: Span | None, asked: Span) -> bool:
    """Return True if a finding is in one of the requested lines, at any column."""
    line, end_line = (span.line, span.end_line) if span else (1, 1)
    return line <= asked.end_line and asked.line <= end_line


def _quick_fix(server: Server, document: Document, repair: Repair) -> types.CodeAction:
    edits = text_edits(document.source, repair.fix.edits, server.encoding)
    return types.CodeAction(
        title=f"{repair.fix.title} ({repair.finding.code})",
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[diagnostic_of(document, repair.finding, server.encoding)],
        is_preferred=repair.is_preferred or None,
        edit=types.WorkspaceEdit(changes={document.uri: edits}),
    )


# Actions for the whole text.


def _renumber(server: Server, document: Document) -> Iterator[types.CodeAction]:
    edits = formatted(document.source, (_START, _STEP))
    if edits:
        yield types.CodeAction(
            title="renumber the commands",
            kind=RENUMBER,
            edit=types.WorkspaceEdit(
                changes={document.uri: text_edits(document.source, edits, server.encoding)}
            ),
        )


def _fixable(document: Document, checked: Checked) -> bool:
    return any(is_repair(one) and _is_own(document, one) for one in checked.diagnostics)


def _fix_all(uri: str) -> types.CodeAction:
    """Return the action that applies all fixes, without its edit. The edit is computed when the user selects
    the action, because each fix has to be tried.
    """
    return types.CodeAction(title="apply all fixes that change no motion", kind=FIX_ALL, data={"uri": uri})


async def _resolve(server: Server, action: types.CodeAction) -> types.CodeAction:
    uri = action.data["uri"] if isinstance(action.data, dict) else None
    document = server.documents.get(str(uri))
    analysis = await server.analyses.whole(str(uri), None) if document else None
    if document is None or analysis is None or analysis.document is not document:
        return action
    text = await server.answer(document.uri, _fixed, server, document, analysis.checked)
    edits = text_edits(document.source, changes_to(document.source, text), server.encoding)
    action.edit = types.WorkspaceEdit(changes={document.uri: edits})
    return action


def _fixed(server: Server, document: Document, checked: Checked) -> str:
    """Return the text with the fixes that `yarc check --fix` applies."""
    if checked.source is None:
        return document.source.text

    def again(source: SourceFile) -> Checked:
        return server.checks.of_text(source, document.folder)

    return fixed(checked, again, is_repair).text


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_CODE_ACTION: (
            _actions,
            types.CodeActionOptions(
                code_action_kinds=[types.CodeActionKind.QuickFix, FIX_ALL, RENUMBER],
                resolve_provider=True,
            ),
        ),
        types.CODE_ACTION_RESOLVE: (_resolve, None),
    }
)
