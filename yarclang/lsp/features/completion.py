"""Completion: the candidates at the place where the user types."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.candidates import Candidate
from yarclang.assist.completion import candidates_at
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, range_of
from yarclang.lsp.translation import markup
from yarclang.source import SourceFile

if TYPE_CHECKING:
    from yarclang.lsp.server import Server

_KINDS = {
    "command": types.CompletionItemKind.Function,
    "declaration": types.CompletionItemKind.Keyword,
    "frame": types.CompletionItemKind.Class,
    "number": types.CompletionItemKind.Variable,
    "table": types.CompletionItemKind.Variable,
    "joints": types.CompletionItemKind.EnumMember,
    "register": types.CompletionItemKind.Variable,
    "tool": types.CompletionItemKind.Value,
    "pose": types.CompletionItemKind.EnumMember,
    "input": types.CompletionItemKind.Property,
    "output": types.CompletionItemKind.Property,
    "sub": types.CompletionItemKind.Method,
    "module": types.CompletionItemKind.Module,
    "parameter": types.CompletionItemKind.Variable,
    "unit": types.CompletionItemKind.Unit,
    "option": types.CompletionItemKind.Keyword,
    "time": types.CompletionItemKind.Keyword,
    "function": types.CompletionItemKind.Function,
    "word": types.CompletionItemKind.Value,
    "robot": types.CompletionItemKind.Struct,
    "finding": types.CompletionItemKind.Constant,
}


def _completion(server: Server, params: types.CompletionParams) -> types.CompletionList | None:
    view = server.program_view(params.text_document.uri)
    if view is None:
        return None
    source = view.sketch.source
    found = candidates_at(view, *place_of(source, params.position, server.encoding))
    # Suffixes of commands are offered only after the name is typed, so the list is incomplete.
    return types.CompletionList(
        is_incomplete=any(one.kind == "command" for one in found),
        items=[_item(server, view.sketch.source, one) for one in found],
    )


def _item(server: Server, source: SourceFile, one: Candidate) -> types.CompletionItem:
    text = server.client_capabilities.text_document
    item = text.completion.completion_item if text and text.completion else None
    fills = bool(item and item.snippet_support)
    documentation = markup(one.documentation, item.documentation_format if item else None)
    return types.CompletionItem(
        label=one.label,
        kind=_KINDS[one.kind],
        detail=one.detail or None,
        documentation=documentation if one.documentation else None,
        sort_text=f"{one.rank:02d}{one.label}",
        filter_text=one.label.rstrip("]}"),  # typing a closing bracket ends the choice
        insert_text_format=types.InsertTextFormat.Snippet if fills and "$" in one.text else None,
        text_edit=types.TextEdit(
            range_of(source, one.span, server.encoding), one.text if fills else one.plain
        ),
    )


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_COMPLETION: (
            _completion,
            types.CompletionOptions(trigger_characters=["{", "[", "(", "$", "_", ".", ","]),
        )
    }
)
