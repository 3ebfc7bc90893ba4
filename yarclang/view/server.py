"""viser's server, which talks to nobody but the pages that it has served itself."""

from __future__ import annotations

from typing import Any
from urllib.parse import urlsplit

import viser

_HERE = {"localhost", "127.0.0.1", "::1"}
"""Names of this machine for itself."""


class GuardedServer(viser.ViserServer):
    """A viser server that opens no tunnel to the outside, and refuses pages of other sites.

    Any page that is open in the same browser could open a connection to this port; its own address goes with it.
    """

    def __init__(self, host: str, port: int) -> None:
        super().__init__(host=host, port=port, verbose=False)
        self._websock_server.on_client_connect(self._refuse_others)

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002  (viser's signature)
        """Never: a client could ask for it, and the picture would be public."""
        return None

    async def _refuse_others(self, client: Any) -> None:
        connection = self._websock_server._live_connections.get(client.client_id)
        if connection is None or connection.request is None:
            return
        headers = connection.request.headers
        if not is_own(headers.get("Origin"), headers.get("Host")):
            await connection.close(1008, "pages of other sites are refused")


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
