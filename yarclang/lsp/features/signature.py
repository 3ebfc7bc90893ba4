"""Signature help: names and units of values while they are typed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.signatures import signature_at
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


def _signature(server: Server, params: types.SignatureHelpParams) -> types.SignatureHelp | None:
    view = server.program_view(params.text_document.uri)
    if view is None:
        return None
    found = signature_at(view, *place_of(view.sketch.source, params.position, server.encoding))
    if found is None:
        return None
    label = " ".join((found.head, *(one.label for one in found.values)))
    parameters = []
    start = len(found.head) + 1
    for one in found.values:
        # All characters are ASCII, so a column is one unit in any encoding.
        parameters.append(types.ParameterInformation((start, start + len(one.label)), one.meaning or None))
        start += len(one.label) + 1
    active = found.active if found.active is not None else len(parameters)
    signature = types.SignatureInformation(label, found.summary, parameters, active)
    return types.SignatureHelp([signature], 0, active)


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_SIGNATURE_HELP: (
            _signature,
            types.SignatureHelpOptions(trigger_characters=[" "], retrigger_characters=[";"]),
        )
    }
)
