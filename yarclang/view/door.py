"""The address at which a picture is served, and the server that listens there."""

from __future__ import annotations

import contextlib
import io
import socket
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import viser

_ALL = {"0.0.0.0", "::"}
"""Hosts that stand for all addresses of this machine."""


@dataclass(frozen=True, slots=True)
class Door:
    """The network address at which the picture is served.

    Attributes:
        host: address to listen on, or its name.
        port: port to listen on.
    """

    host: str
    port: int

    @property
    def url(self) -> str:
        """Return the address for a browser."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}"


class PortTakenError(Exception):
    """The server can't listen at the address. The message has the reason."""


@contextlib.contextmanager
def opened(door: Door) -> Iterator[viser.ViserServer]:
    """Yield a picture server that listens while the context is open. Port 0 means any free port.

    Raises:
        PortTakenError: the port is in use, or the address doesn't belong to this machine.
    """
    server = _open(door)
    try:
        yield server
    finally:
        with contextlib.redirect_stdout(io.StringIO()):
            server.stop()


def _open(door: Door) -> viser.ViserServer:
    # Check the address first: viser would silently use the next free port, and would wait for ever at an
    # address of another machine.
    try:
        family = socket.getaddrinfo(door.host, door.port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family[0], socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(family[4])
            port = probe.getsockname()[1]
    except (OSError, UnicodeError) as error:
        raise PortTakenError((getattr(error, "strerror", None) or str(error)).lower()) from None
    from yarclang.view.server import GuardedServer

    with contextlib.redirect_stdout(io.StringIO()):  # viser prints a table of its own
        return GuardedServer(door.host, port, _names(door))


def _names(door: Door) -> frozenset[str]:
    """Return the names of this machine in the network if the server listens on all addresses, otherwise
    none.
    """
    if door.host not in _ALL:
        return frozenset()
    name = socket.gethostname()
    return frozenset({name, f"{name}.local"})
