"""viser's web server, restricted to requests from pages that this server itself has served
(`yarclang.hosts`).
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from http import HTTPStatus
from typing import Any

import viser
from websockets.asyncio import server as websocket_server

from yarclang.hosts import HERE, is_called, is_own

Request = Callable[[Any, Any], Any]
"""Callback that websockets calls with a connection and its request. It returns a response, or None to let the
server handle the request.
"""


class GuardedServer(viser.ViserServer):
    """A viser server that refuses other host names and pages of other sites, and opens no tunnels to the
    internet.

    Args:
        host: address to listen on, or its name.
        port: port to listen on.
        names: allowed names of the server besides localhost, `host` and the address of the connection.
    """

    def __init__(self, host: str, port: int, names: frozenset[str] = frozenset()) -> None:
        guard = _Guard(HERE | {host.lower()} | {name.lower() for name in names})
        with _guarded(guard):
            super().__init__(host=host, port=port, verbose=False)
        if not guard.is_asked:
            self.stop()
            raise RuntimeError("this version of viser can't be guarded")

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002  (viser's signature)
        """Return None, so that no tunnel is opened. Any client could request a tunnel, which would make
        the picture public.
        """
        return None


class _Guard:
    """A filter that allows or refuses each request for a file or a connection, before the server handles it.

    Attributes:
        is_asked: True if the server has called the filter at least once.
    """

    def __init__(self, names: frozenset[str]) -> None:
        self.is_asked = False
        self._names = names

    def before(self, answer: Request | None) -> Request:
        """Return a callback that first asks this filter, and then the given callback."""
        self.is_asked = True

        def process(connection: Any, request: Any) -> Any:
            reason = self._objection(connection.local_address, request.headers)
            if reason:
                return connection.respond(HTTPStatus.FORBIDDEN, f"{reason}\n")
            return None if answer is None else answer(connection, request)

        return process

    def _objection(self, here: tuple[Any, ...], headers: Any) -> str:
        """Return the reason to refuse a request; empty if it is allowed."""
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        address, port = str(here[0]), int(here[1])
        if len(hosts) != 1 or not is_called(hosts[0], port, self._names | {address}):
            return (
                f"yarc view is not known by this name. On this machine it is at http://localhost:{port}; "
                "start it with --host NAME for another name."
            )
        if len(origins) > 1 or not is_own(origins[0] if origins else None, hosts[0]):
            return "pages of other sites are refused"
        return ""


@contextlib.contextmanager
def _guarded(guard: _Guard) -> Iterator[None]:
    """Make new websocket servers ask a filter before each connection. viser has no option that passes such a
    callback to websockets.
    """
    serve = websocket_server.serve

    def guarded(*arguments: Any, process_request: Request | None = None, **options: Any) -> Any:
        return serve(*arguments, process_request=guard.before(process_request), **options)

    websocket_server.serve = guarded  # type: ignore[misc, assignment]
    try:
        yield
    finally:
        websocket_server.serve = serve  # type: ignore[misc]
