"""Requests that can't be carried out: the person who asked is told why, and nobody else."""

from __future__ import annotations

import logging

from lsprotocol import types
from pygls.exceptions import JsonRpcException


class Refusal(JsonRpcException):
    """A request is refused; the message is for the person who asked."""

    CODE = types.LSPErrorCodes.RequestFailed.value
    MESSAGE = "refused"


class Outdated(Refusal):
    """The text has changed since a request about it came; editors ask again if they still want to know."""

    CODE = types.LSPErrorCodes.ContentModified.value
    MESSAGE = "outdated"


def keep_quiet_about_refusals() -> None:
    """The library logs what is no fault: refusals, with their whole way, and that an editor gave up a question while its answer was on the way."""
    logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_fault)


def _is_fault(record: logging.LogRecord) -> bool:
    if str(record.msg).startswith("Cancel notification for unknown message"):
        return False
    return not (record.exc_info and isinstance(record.exc_info[1], Refusal))
