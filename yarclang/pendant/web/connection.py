"""HTTP connections of the pendant's server. Connections without a request, whose clients needn't be logged
in, can't use up the server's connections and so keep other users from it.
"""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

MOST = 200
"""Number of connections at which further HTTP requests are refused."""

MOST_OF_ONE = 100
"""Largest number of connections from one address. Further ones are closed at once."""

PATIENCE = 10.0
"""Longest time until the head of a request has arrived [s]."""


class Connection(H11Protocol):
    """A connection that is closed if the head of a request doesn't arrive in time. Without this class, only
    an idle connection after a request is closed.
    """

    _deadline: asyncio.TimerHandle | None = None
    _upgraded = False

    def connection_made(self, transport: Any) -> None:
        """Accept the connection, or close it if there are too many from its address."""
        super().connection_made(transport)
        address = (self.client or ())[:1]
        same = sum((getattr(one, "client", None) or ())[:1] == address for one in self.connections)
        if same > MOST_OF_ONE:
            self.transport.abort()
        else:
            self._expect()

    def data_received(self, data: bytes) -> None:
        """Take received bytes."""
        super().data_received(data)
        if self.cycle is None or self.cycle.response_complete:
            self._expect()
        else:
            self._expect_nothing()

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Hand the connection over to a WebSocket."""
        super().handle_websocket_upgrade(event)
        self._upgraded = True
        self._expect_nothing()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._expect_nothing()
        super().connection_lost(exc)

    def _expect(self) -> None:
        if self._deadline is None and not self._upgraded:
            self._deadline = self.loop.call_later(PATIENCE, self.transport.abort)

    def _expect_nothing(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None
