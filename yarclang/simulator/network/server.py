"""The simulator's socket and clock: it serves a simulated controller to clients, and advances the
controller's time with the wall clock.

No other module of the simulator uses clocks or the network.
"""

from __future__ import annotations

import asyncio
import math
import socket
import time
from collections import deque
from collections.abc import Callable, Iterable
from types import TracebackType

from yarclang.pmac import requests as pmac
from yarclang.pmac.requests import Code
from yarclang.simulator.faults import Fault, Troubles
from yarclang.simulator.machine import Machine
from yarclang.simulator.network.ethernet import Packet, PacketReader, Station
from yarclang.simulator.network.leash import AHEAD, Leash, tick

LOOPBACK = "127.0.0.1"
"""Default address to listen on; no other computer can reach it."""

_TICK = 0.005
"""Period at which time is advanced while no packets arrive [s]."""

_FINE = 0.0005
"""Time by which the machine's time may lag behind when a packet is executed [s of the machine]."""

_SLACK = 0.25
"""Longest wall time that the machine catches up after this process couldn't run [s]. The rest of the missed
time is skipped.
"""

_STRIDE = 0.02
"""Largest step of the machine's time [s of the machine]. Without a rate, each pass of the server's loop makes
one such step.
"""

_BURST = 0.005
"""Longest wall time for which the machine's time is advanced before clients are served again [s]."""

_STAY = 0.0002
"""Wall time for which the server waits for the next request after a reply, before any other work [s].

A client that sends its next request immediately gets its reply without delay.
"""

_RECEIVED = 1 << 16
"""Largest number of bytes that are read from a socket at once."""

_MEMORY = 1 << 14
"""Size of the dual-ported memory [bytes]."""


def wall_clock() -> float:
    """Return the time of the wall clock [s], counted from an arbitrary start."""
    return time.monotonic()


class SimulatorServer:
    """Serves a simulated controller on a TCP port, in the running event loop.

    Args:
        machine: the controller. While it is served, no other code may advance it.
        host: address to listen on.
        port: port to listen on; 0 for any free port. The attribute `port` has the port that is used.
        rate: seconds of the machine's time per second; None to run as fast as possible.
        faults: the faults to inject.
        seed: seed of the faults.
        tell: function that is called with a line of text for each event that is unusual or not caused by
            a client.
        leash: makes the machine's time wait for its clients. If None, the machine follows the wall
            clock. It has no effect if the rate is None.
    """

    def __init__(
        self,
        machine: Machine,
        *,
        host: str = LOOPBACK,
        port: int = pmac.PORT,
        rate: float | None = 1.0,
        faults: Iterable[Fault] = (),
        seed: int = 0,
        tell: Callable[[str], None] | None = None,
        leash: Leash | None = None,
    ) -> None:
        self.machine = machine
        self.host = host
        self.port = port
        self.rate = rate
        self._tell = tell
        self.troubles = Troubles(machine, faults, seed, self.tell)
        self.memory = bytearray(_MEMORY)
        self._clients: dict[int, _Client] = {}
        self._server: asyncio.Server | None = None
        self._timer: asyncio.Handle | None = None
        self._since = 0.0
        self._leash = leash
        self._ahead = 0.0
        self._each = _TICK if rate is None else tick(rate)
        self._failed: asyncio.Future[None] | None = None
        self.loop: asyncio.AbstractEventLoop

    async def start(self) -> None:
        """Start to listen, and to advance the machine's time.

        Raises:
            OSError: if the server can't listen on the address.
        """
        self.loop = asyncio.get_running_loop()
        self._failed = self.loop.create_future()
        self._server = await self._listen(self.port)
        ports = [each.getsockname()[1] for each in self._server.sockets]
        if len(set(ports)) > 1:  # each address of the host got another port
            self._server.close()
            self._server = await self._listen(ports[0])
        self.port = ports[0]
        self._since = self.loop.time()
        self._tell_time()
        self._tick()

    async def _listen(self, port: int) -> asyncio.Server:
        return await self.loop.create_server(lambda: _Client(self), self.host, port)

    async def close(self) -> None:
        """Close all connections and stop the time."""
        self._let_go()
        if self._timer is not None:
            self._timer.cancel()
        if self._failed is not None and not self._failed.done():
            self._failed.cancel()
        if self._server is not None:
            self._server.close()
            self.drop_all()
            await self._server.wait_closed()

    async def serve(self) -> None:
        """Wait until the task is cancelled or the machine fails.

        Raises:
            Exception: an error inside the machine, which is a bug of the simulator.
        """
        assert self._failed is not None, "start first"
        await asyncio.shield(self._failed)

    async def __aenter__(self) -> SimulatorServer:
        await self.start()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    def catch_up(self) -> None:
        """Advance the machine's time according to the wall clock."""
        if self.rate is None:
            return
        now = self.loop.time()
        due = min(now - self._since, _SLACK) * self.rate
        if due > (most := self._most()):
            due = most
            self._since = now - due / self.rate  # skip the time beyond the leash
        if due < _FINE:
            return
        while due > 0.0:
            self.troubles.advance(min(due, _STRIDE))
            self._ahead += min(due, _STRIDE)
            due = max(0.0, due - _STRIDE)
            if self.loop.time() - now > _BURST:
                break
        self._since = now - due / self.rate
        self._tell_time()
        self.act()

    def _tell_time(self) -> None:
        if self._leash is not None:
            self._leash.tell(self.machine.now)

    def _most(self) -> float:
        """Return the time by which the machine may be advanced now [s]; infinite without a leash."""
        # If a fault delays a reply, the machine's time must advance, since the delay wouldn't end otherwise.
        if self._leash is None or not self._clients or any(one.kept for one in self._clients.values()):
            return math.inf
        until = self._leash.until
        return max(0.0, AHEAD - self._ahead if until is None else until - self.machine.now)

    def asked(self) -> None:
        """Record that a client has connected, or has sent a request."""
        self._ahead = 0.0

    def tell(self, text: str) -> None:
        """Report an unusual event to the user of the server."""
        if self._tell is not None:
            self._tell(text)

    def wall(self, seconds: float) -> float:
        """Convert a duration of the machine [s] to a duration of the wall clock [s]."""
        return seconds / self.rate if self.rate is not None else seconds

    def act(self) -> None:
        """Apply faults to the connections."""
        if self.troubles.dropped():
            self.drop_all()

    def drop_all(self) -> None:
        """Close all connections at once."""
        for client in list(self._clients.values()):
            client.drop()

    def fail(self, error: Exception) -> None:
        """Close all connections after an error inside the machine, which `serve` raises."""
        self._let_go()
        if self._failed is not None and not self._failed.done():
            self._failed.set_exception(error)
        if self._timer is not None:
            self._timer.cancel()
        self.drop_all()

    def _let_go(self) -> None:
        if self._leash is not None:
            self._leash.stop()

    def join(self, client: _Client) -> int | None:
        """Return the machine's port for a new client; None if all ports are in use."""
        free = [port for port in range(pmac.CLIENTS) if port not in self._clients]
        if not free:
            self.tell(f"another client is refused: the controller keeps {pmac.CLIENTS} connections")
            return None
        self._clients[free[0]] = client
        self.asked()
        return free[0]

    def leave(self, client: _Client) -> None:
        """Remove a client that has disconnected."""
        self._clients = {port: one for port, one in self._clients.items() if one is not client}

    def _tick(self) -> None:
        try:
            if self.rate is None:
                self.troubles.advance(_STRIDE)
                self.act()
            else:
                self.catch_up()
            for client in list(self._clients.values()):
                client.work()
        except Exception as error:
            self.fail(error)
            return
        if self.rate is None:
            self._timer = self.loop.call_soon(self._tick)
        else:
            self._timer = self.loop.call_later(self._each, self._tick)


class _Client(asyncio.Protocol):
    """One connection, which answers packets one after the other."""

    def __init__(self, server: SimulatorServer) -> None:
        self._server = server
        self._reader = PacketReader()
        self._packets: deque[Packet] = deque()
        self._held: asyncio.TimerHandle | None = None
        self._full = False
        self._reading = True
        self._transport: asyncio.Transport | None = None
        self._wire: socket.socket | None = None
        self._station: Station | None = None

    @property
    def kept(self) -> bool:
        """True if a fault delays a reply to this client."""
        troubles = self._server.troubles
        return self._held is not None or (bool(self._packets) and troubles.any and troubles.frozen)

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        port = self._server.join(self)
        if port is None:
            transport.abort()
            return
        self._transport = transport
        self._wire = transport.get_extra_info("socket").dup()
        self._wire.setblocking(False)
        self._station = Station(self._server.machine, port, self._server.memory)

    def data_received(self, data: bytes) -> None:
        begun = time.perf_counter()
        while data:
            self._packets += self._reader.receive(data)
            self.work()
            data = self._at_once() if time.perf_counter() - begun < _TICK else b""

    def _at_once(self) -> bytes:
        """Wait briefly after a reply, and return the bytes that the client sends in this time; empty if there
        are none.

        Waking up from the event loop takes longer than answering. Without this short wait, only a third as
        many requests could be answered.
        """
        wire, transport = self._wire, self._transport
        if (
            wire is None
            or transport is None
            or transport.is_closing()
            or not self._reading
            or self._server.rate is None
        ):
            return b""
        if transport.get_write_buffer_size():
            return b""
        until = time.perf_counter() + _STAY
        while time.perf_counter() < until:
            try:
                return wire.recv(_RECEIVED)
            except BlockingIOError:
                continue
            except OSError:
                break
        return b""  # the event loop reports a closed connection

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002  (asyncio's signature)
        self._server.leave(self)
        self._transport = None
        if self._wire is not None:
            self._wire.close()
        self._packets.clear()
        if self._held is not None:
            self._held.cancel()

    def pause_writing(self) -> None:
        """Stop answering, since the client doesn't read its replies."""
        self._full = True

    def resume_writing(self) -> None:
        self._full = False
        self.work()

    def drop(self) -> None:
        """Close the connection at once."""
        self._packets.clear()
        if self._transport is not None:
            self._transport.abort()

    def work(self) -> None:
        """Answer the packets that can be answered now. Continue to read from the client only if no packet is
        left.
        """
        try:
            self._answer()
        except Exception as error:
            self._server.fail(error)
            return
        if self._reader.broken is not None and not self._packets and self._held is None:
            if self._transport is not None and not self._transport.is_closing():
                self._server.tell(f"a connection is closed: {self._reader.broken}")
            self.drop()
        self._read(not self._packets and self._held is None and not self._full)

    def _answer(self) -> None:
        server, troubles = self._server, self._server.troubles
        while self._packets and self._transport is not None and self._held is None and not self._full:
            server.catch_up()
            if not self._packets or (troubles.any and troubles.frozen):
                break
            packet = self._packets.popleft()
            server.asked()
            assert self._station is not None
            delay = 0.0
            if not troubles.any:
                reply = self._station.answer(packet)
            else:
                busy = packet.code == Code.GETRESPONSE and troubles.busy
                reply, delay = troubles.spoil(b"\x00" if busy else self._station.answer(packet))
                troubles.lines_written(self._station.take_lines())
                server.act()
            if delay > 0.0:
                self._held = server.loop.call_later(server.wall(delay), self._release, reply)
            elif reply:
                self._write(reply)

    def _release(self, reply: bytes) -> None:
        self._held = None
        if self._server.troubles.frozen:  # send the reply after the freeze
            self._held = self._server.loop.call_later(_TICK, self._release, reply)
            return
        self._write(reply)
        self.work()

    def _write(self, reply: bytes) -> None:
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(reply)

    def _read(self, wants_write: bool) -> None:
        if wants_write != self._reading and self._transport is not None and not self._transport.is_closing():
            self._reading = wants_write
            if wants_write:
                self._transport.resume_reading()
            else:
                self._transport.pause_reading()
