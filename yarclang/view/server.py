"""viser's server, which talks only to the pages that it has served itself.

Any page that is open in the same browser can send requests to this port, and its site can give itself this machine's address (DNS rebinding): the browser then takes both for one
site. But the request's Host header still has the name that the browser was sent to, and the Origin of a connection that of its page.
"""

from __future__ import annotations

import contextlib
import ipaddress
import re
from collections.abc import Callable, Iterator
from http import HTTPStatus
from typing import Any
from urllib.parse import urlsplit

import viser
from websockets.asyncio import server as websocket_server

_HERE = {"localhost", "127.0.0.1", "::1"}
"""Names of this machine for itself."""

_HOST = re.compile(
    r"(?:\[(?P<six>[0-9a-f:.]+)\]|(?P<name>[^\s:@/?#\[\]]+))(?::(?P<port>[0-9]{1,5}))?", re.ASCII
)

Request = Callable[[Any, Any], Any]
"""Callback of websockets for a connection and its request: it returns a response, or None to go on."""


class GuardedServer(viser.ViserServer):
    """A viser server that opens no tunnel to the outside, and refuses requests by other names than its own and pages of other sites.

    Args:
        host: address to listen on, or its name.
        port: to listen on.
        names: by which the server may be called, besides localhost, `host` and the address that a connection reaches.
    """

    def __init__(self, host: str, port: int, names: frozenset[str] = frozenset()) -> None:
        guard = _Guard(_HERE | {host.lower()} | {name.lower() for name in names})
        with _guarded(guard):
            super().__init__(host=host, port=port, verbose=False)
        if not guard.is_asked:
            self.stop()
            raise RuntimeError("this version of viser can't be guarded")

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002  (viser's signature)
        """Never: a client could ask for it, and the picture would be public."""
        return None


class _Guard:
    """Decides on each request before anything is answered, be it for a file or for a connection.

    Attributes:
        is_asked: true once the server asks it.
    """

    def __init__(self, names: set[str]) -> None:
        self.is_asked = False
        self._names = names

    def before(self, answer: Request | None) -> Request:
        """Return what asks this guard first, and then goes on as before."""
        self.is_asked = True

        def process(connection: Any, request: Any) -> Any:
            reason = self._objection(connection.local_address, request.headers)
            if reason:
                return connection.respond(HTTPStatus.FORBIDDEN, f"{reason}\n")
            return None if answer is None else answer(connection, request)

        return process

    def _objection(self, here: tuple[Any, ...], headers: Any) -> str:
        """Return why a request is refused; empty: it isn't."""
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        address, port = str(here[0]), int(here[1])
        if len(hosts) != 1 or not is_called(hosts[0], port, self._names | {address}):
            return f"yarc view is not known by this name. On this machine it is at http://localhost:{port}; start it with --host NAME for another name."
        if len(origins) > 1 or not is_own(origins[0] if origins else None, hosts[0]):
            return "pages of other sites are refused"
        return ""


@contextlib.contextmanager
def _guarded(guard: _Guard) -> Iterator[None]:
    """Let the servers that are made meanwhile ask a guard first: viser hands no such question on to websockets."""
    serve = websocket_server.serve

    def guarded(*arguments: Any, process_request: Request | None = None, **options: Any) -> Any:
        return serve(*arguments, process_request=guard.before(process_request), **options)

    websocket_server.serve = guarded  # type: ignore[misc, assignment]
    try:
        yield
    finally:
        websocket_server.serve = serve  # type: ignore[misc]


def is_called(host: str, port: int, names: set[str]) -> bool:
    """Return True if a Host header has one of a server's names, and its port.

    Args:
        host: the header.
        port: that the connection has reached.
        names: names and addresses in lower case.
    """
    found = _HOST.fullmatch(host.lower())
    if found is None or int(found["port"] or 80) != port:
        return False
    return _plain(found["six"] or found["name"].removesuffix(".")) in {_plain(name) for name in names}


def is_own(origin: str | None, host: str | None) -> bool:
    """Whether a page may connect, by the address that it comes from and the one that it connects to; what is no page has no origin."""
    if origin is None:
        return True
    if host is None:
        return False
    page, wanted = urlsplit(origin), urlsplit(f"//{host}")
    try:
        ports = page.port or 80, wanted.port or 80
    except ValueError:
        return False
    names = page.hostname, wanted.hostname
    return ports[0] == ports[1] and (names[0] == names[1] or _HERE.issuperset(name or "" for name in names))


def _plain(name: str) -> str:
    """Return an address in the form that is the same for all ways to write it; a name as it is."""
    try:
        address = ipaddress.ip_address(name.partition("%")[0])
    except ValueError:
        return name
    return str(getattr(address, "ipv4_mapped", None) or address)
