"""Refuse requests, and show the reason only to the user who made the request."""

from __future__ import annotations

import logging

from lsprotocol import types
from pygls.exceptions import JsonRpcException


class Refusal(JsonRpcException):
    """A request is refused. The message is for the user who made it."""

    CODE = types.LSPErrorCodes.RequestFailed.value
    MESSAGE = "refused"


class Outdated(Refusal):
    """The text has changed since the request. Editors repeat the request if they still need the answer."""

    CODE = types.LSPErrorCodes.ContentModified.value
    MESSAGE = "outdated"


def keep_quiet_about_refusals() -> None:
    """Keep pygls from logging refusals and late cancellations, which are no errors."""
    logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_fault)


def _is_fault(record: logging.LogRecord) -> bool:
    if str(record.msg).startswith("Cancel notification for unknown message"):
        return False
    return not (record.exc_info and isinstance(record.exc_info[1], Refusal))
