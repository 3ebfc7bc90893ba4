"""A TCP connection to a controller, in the running event loop."""

from __future__ import annotations

import asyncio


class Wire(asyncio.Protocol):
    """A connection to a controller that carries bytes. The event `arrived` is set when bytes have arrived, or
    the connection has ended.
    """

    def __init__(self) -> None:
        self.arrived = asyncio.Event()
        self.closed = False
        self._received = bytearray()
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Store the transport, by which bytes are sent. Called by asyncio."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        """Store received bytes, and set `arrived`. Called by asyncio."""
        self._received += data
        self.arrived.set()

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002 (asyncio's signature)
        """Record that the connection has ended, and set `arrived`. Called by asyncio."""
        self.closed = True
        self.arrived.set()

    def send(self, data: bytes) -> None:
        """Put bytes on the wire now."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(data)

    def take(self) -> bytes:
        """Return received bytes, each byte once."""
        data = bytes(self._received)
        self._received.clear()
        self.arrived.clear()
        return data

    def close(self) -> None:
        """Close the connection, after the bytes that were given to `send` are sent."""
        if self._transport is not None:
            self._transport.close()


async def connect(host: str, port: int, timeout: float) -> Wire:
    """Make a TCP connection.

    Args:
        host: name or address of the controller.
        port: port of the controller.
        timeout: longest time for connecting [s].

    Raises:
        OSError: the connection can't be made, or not within `timeout`.
    """
    loop = asyncio.get_running_loop()
    try:
        async with asyncio.timeout(timeout):
            _, wire = await loop.create_connection(Wire, host, port)
    except TimeoutError:
        raise OSError(f"no answer within {timeout:g} s") from None
    return wire
