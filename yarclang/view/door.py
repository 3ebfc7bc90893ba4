"""Where a picture is served: the address, and the server that listens there."""

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
"""Hosts that mean all addresses of this machine."""


@dataclass(frozen=True, slots=True)
class Door:
    """Where the picture is served."""

    host: str
    port: int

    @property
    def url(self) -> str:
        """What to type into a browser."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}"


class PortTakenError(Exception):
    """The door can't be opened; the message says why."""


@contextlib.contextmanager
def opened(door: Door) -> Iterator[viser.ViserServer]:
    """Yield a server that listens as long as the context lasts; port 0 takes a free one.

    Raises:
        PortTakenError: something else listens there, or the address isn't one of this machine.
    """
    server = _open(door)
    try:
        yield server
    finally:
        with contextlib.redirect_stdout(io.StringIO()):
            server.stop()


def _open(door: Door) -> viser.ViserServer:
    # viser would take the next free port in silence, and wait for ever for an address that isn't ours
    try:
        family = socket.getaddrinfo(door.host, door.port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family[0], socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(family[4])
            port = probe.getsockname()[1]
    except (OSError, UnicodeError) as error:
        raise PortTakenError((getattr(error, "strerror", None) or str(error)).lower()) from None
    from yarclang.view.server import GuardedServer

    with contextlib.redirect_stdout(io.StringIO()):  # it prints a table of its own
        return GuardedServer(door.host, port, _names(door))


def _names(door: Door) -> frozenset[str]:
    """Return the names of this machine by which others in the network call it, if they are let in by all its addresses."""
    if door.host not in _ALL:
        return frozenset()
    name = socket.gethostname()
    return frozenset({name, f"{name}.local"})
