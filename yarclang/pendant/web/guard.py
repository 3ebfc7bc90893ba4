"""Security checks for every HTTP request and WebSocket before it is processed: of its host name, its
origin and its size. All responses get headers that restrict what browsers do with them.
"""

from __future__ import annotations

import asyncio
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

_SILENCE = 30.0
"""Longest time without data in a body [s]."""
_START, _SLOWEST = 60.0, 10_000
"""Longest time of a body: `_START` [s], plus its size divided by `_SLOWEST` [bytes/s]."""

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
                f"this host name isn't allowed. On this computer use {scheme}://localhost:{port}; to "
                "allow another name, start the pendant with --name NAME."
            )
        if len(origins) > 1 or not is_own(origins[0] if origins else None, hosts[0], scheme):
            return "pages of other sites are refused"
        # A link on another site may open the pages. All other requests from other sites are refused.
        is_link = (
            scope["type"] == "http" and scope["method"] == "GET" and not scope["path"].startswith("/api/")
        )
        if any(site not in (b"same-origin", b"none") for site in sites) and not is_link:
            return "pages of other sites are refused"
        return ""


class TooLarge(Exception):  # noqa: N818 - it is an answer
    """Raised if the body of a request is longer than its route allows."""


class TooSlow(Exception):  # noqa: N818 - it is an answer
    """Raised if the body of a request doesn't arrive in time."""


@dataclass(slots=True)
class Bound:
    """Longest body of a request [bytes]. A route with another limit sets it here before the body is read."""

    most: int = MOST_BODY


def _bounded(receive: Receive, bound: Bound) -> Receive:
    """Return a receiver that raises `TooLarge` if the body exceeds the limit, and `TooSlow` if it doesn't
    arrive in time.
    """
    clock = asyncio.get_running_loop().time
    begun, size, is_complete = clock(), 0, False

    async def received() -> MutableMapping[str, Any]:
        nonlocal size, is_complete
        if is_complete:
            return await receive()
        left = begun + _START + size / _SLOWEST - clock()
        try:
            message = await asyncio.wait_for(receive(), min(left, _SILENCE))
        except TimeoutError:
            raise TooSlow from None
        if message["type"] == "http.request":
            size += len(message.get("body", b""))
            if size > bound.most:
                raise TooLarge
        is_complete = not message.get("more_body", False)
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
