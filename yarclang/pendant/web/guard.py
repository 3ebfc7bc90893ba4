"""Security checks for every HTTP request and WebSocket before it is processed: of its host name, its
origin and its size. All responses get headers that restrict what browsers do with them.
"""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass
from typing import Any

from yarclang.hosts import HERE, is_called, is_own

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

MOST_BODY = 1 << 20
"""Longest body of a request if its route sets no other limit [bytes]."""

BOUND = "yarclang.bound"
"""Key of the size limit in a request's scope."""

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

_HEADERS = (
    (b"content-security-policy", _POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"permissions-policy", b"gamepad=(self), camera=(), microphone=(), geolocation=(), usb=(), serial=()"),
)


class Guard:
    """ASGI middleware that refuses requests to unknown host names, requests from pages of other sites, and
    requests with too large bodies.

    Args:
        app: application that serves the requests that aren't refused.
        names: host names of the server, in addition to this machine's names for itself and the address to
            which the client has connected.
    """

    def __init__(self, app: App, names: frozenset[str] = frozenset()) -> None:
        self._app = app
        self._names = HERE | {name.lower() for name in names}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve or refuse a request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if reason := self._objection(scope):
            await _refuse(scope, receive, send, reason)
            return
        if scope["type"] == "websocket":
            await self._app(scope, receive, send)
            return
        headers = [*_HEADERS]
        if scope["scheme"] == "https":
            headers.append((b"strict-transport-security", b"max-age=31536000"))

        async def told(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                given = {name for name, _ in message["headers"]}
                message["headers"] = [*message["headers"], *(one for one in headers if one[0] not in given)]
            await send(message)

        bound = scope[BOUND] = Bound()
        await self._app(scope, _bounded(receive, bound), told)

    def _objection(self, scope: Scope) -> str:
        """Return the reason for which a request is refused; empty if it isn't."""
        hosts = [value.decode("latin-1") for name, value in scope["headers"] if name == b"host"]
        origins = [value.decode("latin-1") for name, value in scope["headers"] if name == b"origin"]
        sites = [value for name, value in scope["headers"] if name == b"sec-fetch-site"]
        scheme = "https" if scope["scheme"] in ("https", "wss") else "http"
        address, port = scope["server"] or ("", 0)
        if len(hosts) != 1 or not is_called(hosts[0], int(port or 0), self._names | {str(address)}, scheme):
            return (
                f"the pendant is not known by this name. On this machine it is at "
                f"{scheme}://localhost:{port}; "
                "start it with --name NAME for another name."
            )
        if len(origins) > 1 or not is_own(origins[0] if origins else None, hosts[0], scheme):
            return "pages of other sites are refused"
        # Another site may link to the pages, but must not send any other request.
        is_link = (
            scope["type"] == "http" and scope["method"] == "GET" and not scope["path"].startswith("/api/")
        )
        if any(site not in (b"same-origin", b"none") for site in sites) and not is_link:
            return "pages of other sites are refused"
        return ""


class TooLarge(Exception):  # noqa: N818 - it is an answer
    """Raised if the body of a request is longer than its route allows."""


@dataclass(slots=True)
class Bound:
    """Longest body of a request [bytes]. A route with another limit sets it here before the body is read."""

    most: int = MOST_BODY


def _bounded(receive: Receive, bound: Bound) -> Receive:
    """Return a receiver that raises `TooLarge` if the body exceeds the limit."""
    size = 0

    async def received() -> MutableMapping[str, Any]:
        nonlocal size
        message = await receive()
        if message["type"] == "http.request":
            size += len(message.get("body", b""))
            if size > bound.most:
                raise TooLarge
        return message

    return received


async def _refuse(scope: Scope, receive: Receive, send: Send, reason: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 4403, "reason": reason[:100]})
        return
    body = json.dumps({"ok": False, "error": reason}).encode()
    headers = [
        (b"content-type", b"application/json"),
        (b"content-length", str(len(body)).encode()),
        *_HEADERS,
    ]
    await send({"type": "http.response.start", "status": 403, "headers": headers})
    await send({"type": "http.response.body", "body": body})
