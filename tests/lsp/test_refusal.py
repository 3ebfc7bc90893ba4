"""The server writes only faults into an editor's log, no refusals."""

import logging

import pytest
from pygls.protocol.json_rpc import JsonRPCProtocol

from yarclang.lsp.refusal import Refusal, keep_quiet_about_refusals

LOG = logging.getLogger("pygls.protocol.json_rpc")


@pytest.fixture
def quiet():
    before = list(LOG.filters)
    keep_quiet_about_refusals()
    yield
    LOG.filters[:] = before


def test_only_faults_are_logged(quiet, caplog):
    protocol = JsonRPCProtocol.__new__(JsonRPCProtocol)
    protocol._request_futures = {}
    protocol._handle_cancel_notification(7)  # the editor cancels a request that was already answered
    for error in (Refusal("not this name"), ValueError("a fault")):
        try:
            raise error
        except Exception:
            LOG.exception("failed")
    assert [one.exc_info[1].args for one in caplog.records] == [("a fault",)]
