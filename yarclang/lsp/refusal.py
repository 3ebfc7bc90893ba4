"""Requests that can't be carried out: the person who asked is told why, and nobody else."""

from __future__ import annotations

import logging

from lsprotocol import types
from pygls.exceptions import JsonRpcException


class Refusal(JsonRpcException):
    """A request is refused; the message is for the person who asked."""

    CODE = types.LSPErrorCodes.RequestFailed.value
    MESSAGE = "refused"


def keep_quiet_about_refusals() -> None:
    """The library logs whatever is raised, with its whole way; a refusal is no fault."""
    logging.getLogger("pygls.protocol.json_rpc").addFilter(
        lambda record: not (record.exc_info and isinstance(record.exc_info[1], Refusal))
    )
