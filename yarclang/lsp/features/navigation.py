"""Definition, references and rename, across the files of a folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.cell_names import cell_of_name, rename_in_cell
from yarclang.assist.navigation import (
    Place,
    RenameError,
    definition_at,
    references,
    renamable_at,
    rename,
    target_at,
)
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, range_of
from yarclang.lsp.refusal import Refusal
from yarclang.lsp.translation import text_edits

if TYPE_CHECKING:
    from yarclang.diagnostics import Edit
    from yarclang.lsp.server import Server
    from yarclang.source import SourceFile


def _location(server: Server, place: Place) -> types.Location:
    return types.Location(
        server.uri_of(place.source.name), range_of(place.source, place.span, server.encoding)
    )


def _definition(server: Server, params: types.DefinitionParams) -> types.Location | None:
    view = server.program_view(params.text_document.uri)
    if view is None:
        return None
    place = definition_at(view, *place_of(view.sketch.source, params.position, server.encoding))
    return _location(server, place) if place else None


def _references(server: Server, params: types.ReferenceParams) -> list[types.Location]:
    view = server.program_view(params.text_document.uri)
    if view is None:
        return []
    target = target_at(view, *place_of(view.sketch.source, params.position, server.encoding))
    if target is None:
        return []
    views = server.views_beside(params.text_document.uri, target.sketch.source.name)
    found = references(target, views, declaration=params.context.include_declaration)
    return [_location(server, place) for place in found]


def _highlights(server: Server, params: types.DocumentHighlightParams) -> list[types.DocumentHighlight]:
    view = server.program_view(params.text_document.uri)
    if view is None:
        return []
    source = view.sketch.source
    target = target_at(view, *place_of(source, params.position, server.encoding))
    if target is None:
        return []
    found = [one for one in references(target, [view]) if one.source.name == source.name]
    return [types.DocumentHighlight(range_of(source, one.span, server.encoding)) for one in found]


def _prepare(server: Server, params: types.PrepareRenameParams) -> types.Range | None:
    view = server.program_view(params.text_document.uri)
    if view is None:
        return None
    source = view.sketch.source
    at = place_of(source, params.position, server.encoding)
    named = view.sketch.named_at(*at)
    if named is not None and cell_of_name(view, named) is not None:
        return range_of(source, named.span, server.encoding)
    try:
        place = renamable_at(view, *at)
    except RenameError as error:
        raise Refusal(str(error)) from None
    return range_of(source, place.span, server.encoding)


def _rename(server: Server, params: types.RenameParams) -> types.WorkspaceEdit | None:
    uri = params.text_document.uri
    view = server.program_view(uri)
    if view is None:
        return None
    at = place_of(view.sketch.source, params.position, server.encoding)
    named = view.sketch.named_at(*at)
    in_cell = cell_of_name(view, named) if named is not None else None
    try:
        if in_cell is not None and named is not None:
            edits = rename_in_cell(in_cell, named, params.new_name, server.views_beside(uri))
            return _changes(server, edits)
        renamable_at(view, *at)
        target = target_at(view, *at)
        assert target is not None  # otherwise `renamable_at` has raised
        edits = rename(target, server.views_beside(uri, target.sketch.source.name), params.new_name)
    except RenameError as error:
        raise Refusal(str(error)) from None
    return _changes(server, edits)


def _changes(server: Server, edits: dict[SourceFile, list[Edit]]) -> types.WorkspaceEdit:
    changes = {
        server.uri_of(source.name): text_edits(source, made, server.encoding)
        for source, made in edits.items()
    }
    return types.WorkspaceEdit(changes=changes)


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_DEFINITION: (_definition, types.DefinitionOptions()),
        types.TEXT_DOCUMENT_REFERENCES: (_references, types.ReferenceOptions()),
        types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: (_highlights, types.DocumentHighlightOptions()),
        types.TEXT_DOCUMENT_PREPARE_RENAME: (_prepare, None),
        types.TEXT_DOCUMENT_RENAME: (_rename, types.RenameOptions(prepare_provider=True)),
    }
)
