"""Run the server's process and its connection to the client."""

from __future__ import annotations

import gc
import logging
import socket
import sys
from typing import BinaryIO, cast

from yarclang.lsp.refusal import keep_quiet_about_refusals
from yarclang.lsp.server import Server
from yarclang.pipeline.inputs import Options

_BEGIN = b"content-"
"""Beginning of each message: the protocol requires Content-Length or Content-Type, in capital or small
letters.
"""

_PATIENCE = 5.0
"""Longest time in which an editor must send its first message [s]."""

SELDOM = (50_000, 20, 20)
"""Thresholds for `gc.set_threshold`. They are higher than Python's own, so that the garbage collector runs
seldom.
"""


def serve(address: tuple[str, int] | None, robot: str | None = None) -> None:
    """Serve one editor by the Language Server Protocol until it leaves.

    Args:
        address: host and port to listen on; None for standard input and output.
        robot: robot of programs that name none.
    """
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(levelname)s: %(message)s")
    keep_quiet_about_refusals()
    # The syntax trees of long programs exist for a long time. Fewer collections scan them less often.
    gc.set_threshold(*SELDOM)
    sys.setswitchinterval(0.001)  # answers don't wait for a motion that is being planned
    server = Server(Options(robot=robot))
    if address is None:
        server.start_io()
        return
    with _editor(*address) as wire, wire.makefile("rb") as said, wire.makefile("wb") as answered:
        server.start_io(cast("BinaryIO", said), cast("BinaryIO", answered))


def _editor(host: str, port: int) -> socket.socket:
    """Wait until an editor connects to the server's port.

    Any page in a browser can connect to a port of this computer. Connections that don't begin as the protocol
    requires are therefore closed.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.create_server((host, port), family=family) as listener:
        while True:
            wire, _ = listener.accept()
            if _begins_as_an_editor(wire):
                return wire
            logging.warning("a connection that isn't an editor was refused")
            wire.close()


def _begins_as_an_editor(wire: socket.socket) -> bool:
    wire.settimeout(_PATIENCE)
    try:
        begin = wire.recv(len(_BEGIN), socket.MSG_PEEK | socket.MSG_WAITALL)
    except OSError:
        return False
    wire.settimeout(None)
    return begin.lower() == _BEGIN
