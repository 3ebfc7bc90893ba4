"""The sockets of the ROS door. They are served in the event loop in which the coordinator runs. One client
moves the robot on the motion link, and many clients can receive the robot's state on the state link.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders
from yarclang.robot.model import Robot
from yarclang.ros.carrying import Carrying, Say
from yarclang.ros.motion import MotionLink
from yarclang.ros.refusal import Refusal
from yarclang.ros.simple_message import (
    SLOTS,
    ByteOrder,
    Comm,
    Decoder,
    FrameError,
    Message,
    Ping,
    Sequence,
    TrajectoryPoint,
    encode,
    reply_to,
)
from yarclang.ros.state import Feedback
from yarclang.runtime.actions import Trouble

Attach = Callable[[str], Awaitable[Attached]]
"""Function that attaches a new client to the coordinator. Its argument is the name that other clients see."""

EACH = 0.025
"""Time between two messages of each kind on the state link [s]."""

NAME = "ros"
"""Name of this client at the coordinator."""

_HEALTH_EACH = 0.5
_AGAIN = 1.0
"""Time between two attempts to reach the coordinator [s]."""

_SILENT = 5.0
"""Time without a message of the coordinator after which positions aren't sent any more [s]."""

_PIECE = 4096
"""Largest number of bytes that are read from one client at a time."""

_MOST_UNREAD = 1 << 16
"""Largest number of bytes that may wait for a client that doesn't read them. If there are more, its
connection is closed.
"""

_SENT = 1 << 14
"""Size of the system's send buffer for a client [bytes]. It is small, so that clients don't receive old
positions.
"""

_MOST_LISTENERS = 16
_MOST_WAITING = 4
"""Largest number of clients on the motion link, including the one that may move the robot."""

_SAME_TEXT = 5.0
"""Shortest time until the same line is printed again [s], because a rejected client reconnects repeatedly."""

_GONE = ((socket.TCP_KEEPIDLE, 2), (socket.TCP_KEEPINTVL, 1), (socket.TCP_KEEPCNT, 3))
"""Socket options by which a connection is recognized as dead within about 5 s after the client's computer
has failed.
"""


@dataclass(frozen=True, slots=True)
class Place:
    """Address of a ROS door.

    Attributes:
        host: network address or host name on which to listen.
        motion: port of the motion link; 0 for any free port.
        state: port of the state link; 0 for any free port.
    """

    host: str = "127.0.0.1"
    motion: int = 11000
    state: int = 11002


class _Client(asyncio.BufferedProtocol):
    """A connection, which converts bytes to messages and back."""

    def __init__(self, door: _Door) -> None:
        self._door = door
        self._decoder = Decoder(door.order)
        self._buffer = bytearray(_PIECE)
        self._transport: asyncio.Transport | None = None
        self.name = "?"

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        peer = transport.get_extra_info("peername")
        self.name = f"{peer[0]}:{peer[1]}" if peer else "?"
        wire = transport.get_extra_info("socket")
        wire.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        wire.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SENT)
        for option, value in _GONE:
            wire.setsockopt(socket.IPPROTO_TCP, option, value)
        self._joins()

    def get_buffer(self, sizehint: int) -> bytearray:  # noqa: ARG002  (asyncio's signature)
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        try:
            for message in self._decoder.feed(bytes(self._buffer[:nbytes])):
                self._take(message)
        except FrameError as error:
            self._door.say(f"[Y1621] {self.name} is disconnected: {error}")
            self.close()

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002  (asyncio's signature)
        self._leaves()

    def send(self, message: Message) -> None:
        """Send a message."""
        self.write(encode(message, self._door.order))

    def write(self, frames: bytes) -> None:
        """Send frames. A client that doesn't read is disconnected."""
        if self._transport is None or self._transport.is_closing():
            return
        if self._transport.get_write_buffer_size() > _MOST_UNREAD:
            self._door.say(f"{self.name} is disconnected: it doesn't read what it is sent")
            self._transport.abort()
            return
        self._transport.write(frames)

    def close(self) -> None:
        """Close the connection after everything was sent."""
        if self._transport is not None:
            self._transport.close()

    @property
    def has_gone(self) -> bool:
        """True if the other side has closed the connection, even if asyncio hasn't reported this yet."""
        if self._transport is None or self._transport.is_closing():
            return True
        with socket.socket(fileno=os.dup(self._transport.get_extra_info("socket").fileno())) as wire:
            try:
                return not wire.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT)
            except BlockingIOError:
                return False
            except OSError:
                return True

    def _joins(self) -> None:
        raise NotImplementedError

    def _leaves(self) -> None:
        raise NotImplementedError

    def _take(self, message: Message) -> None:
        raise NotImplementedError


class _Mover(_Client):
    """A client on the motion link."""

    def _joins(self) -> None:
        self._door.mover_came(self)

    def _leaves(self) -> None:
        self._door.mover_left(self)

    def _take(self, message: Message) -> None:
        self._door.mover_said(self, message)


class _Listener(_Client):
    """A client on the state link."""

    def _joins(self) -> None:
        self._door.listener_came(self)

    def _leaves(self) -> None:
        self._door.listeners.discard(self)

    def _take(self, message: Message) -> None:
        if message.comm is Comm.REQUEST:
            self.send(reply_to(message, success=isinstance(message.body, Ping)))


class _Door:
    """State of the ROS door that the motion link and the state link share."""

    def __init__(self, robot: Robot, attach: Attach, order: ByteOrder, say: Say, link: MotionLink) -> None:
        self.order = order
        self.listeners: set[_Listener] = set()
        self._robot = robot
        self._attach = attach
        self._say = say
        self._said: dict[str, float] = {}
        self._link = link
        self._carrying = Carrying(robot, link, self.say)
        self._feedback: Feedback | None = None
        self._movers: list[_Mover] = []

    def say(self, text: str) -> None:
        """Print a line, unless the same line was printed recently."""
        now = asyncio.get_running_loop().time()
        self._said = {one: at for one, at in self._said.items() if now - at < _SAME_TEXT}
        if text not in self._said:
            self._said[text] = now
            self._say(text)

    # the motion link

    def mover_came(self, client: _Mover) -> None:
        """Handle the connection of a client that wants to move the robot. A second client waits until the
        first one has disconnected.
        """
        if len(self._movers) >= _MOST_WAITING:
            client.close()
            return
        self._movers.append(client)
        if self._movers[0] is client:
            self._connected()
        else:
            self.say(
                f"[Y1625] {client.name} waits on the motion link: {self._movers[0].name} moves the robot"
            )

    def mover_left(self, client: _Mover) -> None:
        """Handle the disconnection of a client. The next client may move the robot then."""
        if client not in self._movers:
            return
        was_first = self._movers[0] is client
        self._movers.remove(client)
        if was_first:
            self._carrying.do(self._link.disconnected(asyncio.get_running_loop().time()))
            if self._movers:
                self._connected()

    def mover_said(self, client: _Mover, message: Message) -> None:
        """Handle a message of the motion link."""
        if client not in self._movers:
            return
        if self._movers[0] is not client and self._movers[0].has_gone:
            first = self._movers[0]
            self.mover_left(first)
            first.close()
        is_stop = isinstance(message.body, TrajectoryPoint) and message.body.sequence == Sequence.STOP
        if self._movers[0] is client or is_stop:
            now = asyncio.get_running_loop().time()
            self._carrying.do(self._link.heard(message, now), client.send)
        elif message.comm is not Comm.REPLY:
            self.say(
                f"[Y1625] {client.name} is disconnected: {self._movers[0].name} moves the robot; one "
                f"client at a time can"
            )
            if message.comm is Comm.REQUEST:
                client.send(reply_to(message, success=False))
            client.close()

    def _connected(self) -> None:
        self.say(f"{self._movers[0].name} may move the robot")
        self._carrying.do(self._link.connected())

    # the state link

    def listener_came(self, client: _Listener) -> None:
        """Begin to send the state to a client."""
        if len(self.listeners) >= _MOST_LISTENERS:
            self.say(f"{client.name} is disconnected: the state link already has {_MOST_LISTENERS} clients")
            client.close()
            return
        self.listeners.add(client)

    async def tell(self) -> None:
        """Send the state 40 times a second while a client listens."""
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            if self.listeners:
                frames = self._frames()
                for one in tuple(self.listeners):
                    one.write(frames)
            due = max(due + EACH, loop.time())
            await asyncio.sleep(due - loop.time())

    def _frames(self) -> bytes:
        feedback, seat = self._feedback, self._carrying.seat
        if feedback is None or seat is None:
            return b""
        position = feedback.position() if seat.silence < _SILENT else None
        status = feedback.status(self._link.refusal)
        return (b"" if position is None else encode(position, self.order)) + encode(status, self.order)

    # the coordinator

    async def start(self) -> None:
        """Attach to the coordinator.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        seat = await self._attach(NAME)
        self._feedback = Feedback(self._robot, seat.welcome.name, seat.welcome.status)
        self._carrying.seat = seat

    async def listen(self) -> None:
        """Listen to the coordinator until cancelled. Reconnect if the connection is lost."""
        while True:
            with contextlib.suppress(Trouble):
                if self._carrying.seat is None:
                    await self.start()
                    self.say(f"the coordinator of {self._robot.name} is back")
                await self._hear()
            if self._carrying.seat is not None:
                self.say(
                    f"the coordinator of {self._robot.name} has gone: look at the robot; it is looked "
                    f"for again"
                )
            self._carrying.seat = self._feedback = None
            await asyncio.sleep(_AGAIN)

    async def _hear(self) -> None:
        seat, feedback = self._carrying.seat, self._feedback
        assert seat is not None
        assert feedback is not None
        with await seat.listen() as stream:
            asking = asyncio.ensure_future(self._ask_health(seat, feedback))
            try:
                async for event in stream:
                    before = feedback.trouble()
                    feedback.hear(event)
                    self._say_trouble(before, feedback.trouble())
            finally:
                asking.cancel()

    def _say_trouble(self, before: Refusal | None, now: Refusal | None) -> None:
        if now is not None and now != before:
            self.say(f"the robot doesn't move: {now}")

    async def _ask_health(self, seat: Attached, feedback: Feedback) -> None:
        while True:
            with contextlib.suppress(Trouble):
                feedback.health(await seat.ask(orders.AskHealth()))
            await asyncio.sleep(_HEALTH_EACH)

    async def close(self) -> None:
        """Disconnect all clients, and bring the robot to rest on its path."""
        for one in (*self._movers, *self.listeners):
            one.close()
        await self._carrying.close()
        if self._carrying.seat is not None:
            with contextlib.suppress(Trouble):
                await self._carrying.seat.leave()


@asynccontextmanager
async def served(
    robot: Robot,
    attach: Attach,
    place: Place,
    say: Say,
    *,
    order: ByteOrder = ByteOrder.LITTLE,
    hold_on_disconnect: bool = False,
) -> AsyncIterator[tuple[int, int]]:
    """Serve a ROS door until the context ends.

    Args:
        robot: the robot.
        attach: attaches new clients to its coordinator.
        place: address on which to listen.
        say: prints a line on the terminal.
        order: order of the bytes in all messages.
        hold_on_disconnect: True to hold the robot if the client on the motion link disconnects.

    Yields:
        The ports of the motion link and of the state link.

    Raises:
        Trouble: a port is taken, the robot has too many joints, or the coordinator can't be reached.
    """
    if robot.size > SLOTS:
        what = f"{robot.name} has {robot.size} joints, and simple_message has room for {SLOTS}"
        raise Trouble(what, "move it by another interface", "")
    loop = asyncio.get_running_loop()
    with contextlib.ExitStack() as wires:
        motion, state = (
            wires.enter_context(contextlib.closing(_listener(place.host, port)))
            for port in (place.motion, place.state)
        )
        link = MotionLink(robot.size, hold_on_disconnect=hold_on_disconnect)
        door = _Door(robot, attach, order, say, link)
        await door.start()
        servers = [
            await loop.create_server(lambda: _Mover(door), sock=motion),
            await loop.create_server(lambda: _Listener(door), sock=state),
        ]
        tasks = [asyncio.create_task(door.listen()), asyncio.create_task(door.tell())]
        try:
            yield motion.getsockname()[1], state.getsockname()[1]
        finally:
            for server in servers:
                server.close()
            for task in tasks:
                task.cancel()
                with contextlib.suppress(asyncio.CancelledError):
                    await task
            await door.close()


def _listener(host: str, port: int) -> socket.socket:
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(found[4][:2], family=found[0], backlog=16)
    except (OSError, OverflowError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise Trouble(
            f"{host} port {port} can't be listened on: {reason}",
            "choose other ports with --port, or another --host",
            "",
        ) from None
