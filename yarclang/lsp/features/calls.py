"""Call hierarchy: the callers of a SUB, and the SUBs that it calls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from yarclang.assist.calls import Caller, Calls, callable_at, incoming, outgoing
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import place_of, range_of

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


def _item(server: Server, caller: Caller) -> types.CallHierarchyItem:
    source = caller.source
    return types.CallHierarchyItem(
        name=caller.name,
        kind=types.SymbolKind.Function if caller.symbol else types.SymbolKind.File,
        uri=server.uri_of(source.name),
        range=range_of(source, caller.span, server.encoding),
        selection_range=range_of(source, caller.name_span, server.encoding),
        detail=source.name.replace("\\", "/").rpartition("/")[2] if caller.symbol else None,
    )


def _prepare(
    server: Server, params: types.CallHierarchyPrepareParams
) -> list[types.CallHierarchyItem] | None:
    view = server.program_view(params.text_document.uri)
    if view is None:
        return None
    found = callable_at(view, *place_of(view.sketch.source, params.position, server.encoding))
    return [_item(server, found)] if found else None


def _incoming(
    server: Server, params: types.CallHierarchyIncomingCallsParams
) -> list[types.CallHierarchyIncomingCall] | None:
    found = server.caller_of(params.item)
    if found is None:
        return None
    caller, views = found
    return [
        types.CallHierarchyIncomingCall(_item(server, one.caller), _ranges(server, one))
        for one in incoming(caller, views)
    ]


def _outgoing(
    server: Server, params: types.CallHierarchyOutgoingCallsParams
) -> list[types.CallHierarchyOutgoingCall] | None:
    found = server.caller_of(params.item)
    if found is None:
        return None
    caller, views = found
    view = next((one for one in views if one.sketch.source.name == caller.source.name), None)
    if view is None:
        return None
    return [
        types.CallHierarchyOutgoingCall(_item(server, one.caller), _ranges(server, one))
        for one in outgoing(caller, view)
    ]


def _ranges(server: Server, calls: Calls) -> list[types.Range]:
    return [range_of(one.source, one.span, server.encoding) for one in calls.places]


FEATURE = Feature(
    {
        types.TEXT_DOCUMENT_PREPARE_CALL_HIERARCHY: (_prepare, types.CallHierarchyOptions()),
        types.CALL_HIERARCHY_INCOMING_CALLS: (_incoming, None),
        types.CALL_HIERARCHY_OUTGOING_CALLS: (_outgoing, None),
    }
)
