"""From a process to a server that talks to its client."""

from __future__ import annotations

import gc
import logging
import sys

from yarclang.lsp.refusal import keep_quiet_about_refusals
from yarclang.lsp.server import Server
from yarclang.pipeline.inputs import Options

SELDOM = (50_000, 20, 20)
"""How many more objects, and how many rounds, Python waits before it looks through them for garbage."""


def serve(address: tuple[str, int] | None, robot: str | None = None) -> None:
    """Serve one client until it leaves.

    Args:
        address: host and port to wait on; None: standard input and output.
        robot: the robot of programs that name none.
    """
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(levelname)s: %(message)s")
    keep_quiet_about_refusals()
    # trees of a long program are no garbage, and were looked through again and again
    gc.set_threshold(*SELDOM)
    sys.setswitchinterval(0.001)  # an answer doesn't wait for a motion that is being planned
    server = Server(Options(robot=robot))
    if address is None:
        server.start_io()
    else:
        server.start_tcp(*address)
