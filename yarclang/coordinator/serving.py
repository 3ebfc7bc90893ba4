"""The socket of a coordinator. Other processes of the same user send orders and questions through it, and
receive events. Each line contains one JSON object (`messages/`).

The socket is in a folder that only its owner may enter, and the kernel reports the user of each caller. No
caller can delay the robot: stops are carried out as soon as they are read, and a caller that doesn't read its
replies is disconnected.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict, deque
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from yarclang.coordinator.client import Client
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.desk import Desk, welcome
from yarclang.coordinator.mailbox import CAPACITY
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.events import BaseEvent
from yarclang.coordinator.messages.lines import (
    MOST_LINE,
    Asked,
    Id,
    denied,
    name_of,
    read_order,
    too_long,
    write_answer,
    write_event,
)
from yarclang.coordinator.messages.orders import Order
from yarclang.coordinator.messages.replies import Denied, Done, Reply
from yarclang.coordinator.subscription import Subscription
from yarclang.runtime.actions import Trouble
from yarclang.runtime.transports.private import folder, own_name, peer_of, private_listener
from yarclang.runtime.transports.runs import remove_stale

_LAST = 0.01
"""Time for which the server still accepts callers after it has removed its socket [s]. Otherwise a connection
that was made just before would be lost.
"""

_MOST_UNREAD = 1024
"""Largest number of replies and events that are stored for a caller that doesn't read them. If there are
more, the connection is closed.
"""

_LINES = 32
"""Number of the latest events whose encoded lines are stored. So each event is encoded only once for all
clients.
"""

_MOST_WAITING = 16
"""Largest number of orders of one caller that are carried out at the same time."""

_FOR_ANYBODY = (
    orders.AskStatus,
    orders.Hold,
    orders.Resume,
    orders.Step,
    orders.Stop,
    orders.Abort,
    orders.Override,
)
"""Orders that are allowed without a preceding `hello` (the order by which a caller becomes a client), so that
they can be given from any terminal.
"""

_NAMELESS = "another terminal"


class ControlSocket:
    """Server that lets other processes be clients of a coordinator. It listens until the context ends.

    Args:
        coordinator: the coordinator.

    Attributes:
        path: path of the socket, once it listens.
    """

    def __init__(self, coordinator: Coordinator) -> None:
        self.path = Path()
        self._coordinator = coordinator
        self._server: asyncio.Server | None = None
        self._visitors: dict[asyncio.Task[None], asyncio.StreamWriter] = {}
        self._written = Written()

    async def __aenter__(self) -> ControlSocket:
        """Begin to listen.

        Raises:
            ControlError: the socket can't be opened.
        """
        place = folder()
        remove_stale(place)
        self.path = place / f"{own_name(self._coordinator.robot.name)}.sock"
        wire = private_listener(self.path)
        self._server = await asyncio.start_unix_server(self._accept, sock=wire, limit=MOST_LINE)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Disconnect all callers, and remove the socket."""
        self.path.unlink(missing_ok=True)
        await asyncio.sleep(_LAST)
        if self._server is not None:
            self._server.close()
        for task, writer in self._visitors.items():
            task.cancel()
            writer.transport.abort()
        await asyncio.gather(*self._visitors, return_exceptions=True)
        await asyncio.sleep(0)  # the event loop closes connections in its next turn

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if not peer_of(writer.get_extra_info("socket")).is_trusted:
            writer.write(write_answer(Denied(error="processes of other users can't give orders here")))
            writer.close()
            return
        visitor = Visitor(self._coordinator, reader, writer, self._written)
        task = asyncio.get_running_loop().create_task(visitor.serve())
        self._visitors[task] = writer
        task.add_done_callback(self._visitors.pop)


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a connection: the types of orders that are allowed, a description of these orders for
    messages, and the longest line [bytes].
    """

    allowed: tuple[type[Order[Any]], ...]
    said: str
    most_line: int


class Written:
    """Events as lines. Each event is encoded only once for all clients."""

    def __init__(self) -> None:
        self._lines: OrderedDict[int, tuple[BaseEvent, bytes]] = OrderedDict()

    def line(self, event: BaseEvent) -> bytes:
        """Return the line of an event."""
        known = self._lines.get(id(event))
        if known is not None:  # the stored event stays alive, so no other event has its id
            return known[1]
        line = write_event(event)
        self._lines[id(event)] = event, line
        if len(self._lines) > _LINES:
            self._lines.popitem(last=False)
        return line


class Visitor:
    """A connection with one caller.

    Args:
        coordinator: the coordinator.
        reader: reader of the connection.
        writer: writer of the connection.
        written: converts events to lines of text.
        limits: allowed orders; None: all.
    """

    def __init__(
        self,
        coordinator: Coordinator,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        written: Written,
        limits: Limits | None = None,
    ) -> None:
        self._limits = limits
        self._coordinator = coordinator
        self._reader = reader
        self._writer = writer
        self._written = written
        self._client: Client | None = None
        self._desk = Desk(coordinator, Client(coordinator, _NAMELESS))
        self._events: Subscription | None = None
        self._outgoing: deque[bytes] = deque()
        self._wanted = asyncio.Event()
        self._carried_out: set[asyncio.Future[Any]] = set()

    async def serve(self) -> None:
        """Serve a caller until it leaves. The caller's right to give orders has been checked before."""
        writing = asyncio.create_task(self._write())
        try:
            while line := await self._line():
                asked = Asked(line, ends=True) if isinstance(line, Denied) else read_order(line, self._most)
                self._take(asked)
                if asked.ends:
                    break
                await asyncio.sleep(0)  # other tasks run after each answer, even in a flood of questions
            await self._last_words(writing)
        except ConnectionError:
            pass  # the caller has gone
        finally:
            self._leave()
            writing.cancel()
            self._writer.close()

    @property
    def _most(self) -> int:
        return MOST_LINE if self._limits is None else self._limits.most_line

    async def _line(self) -> bytes | Denied:
        """Return the next line; empty at the end of the connection. An incomplete last line is ignored, so
        that an order isn't executed if its caller dies while writing it.
        """
        try:
            line = await self._reader.readline()
        except ValueError:  # longer than the reader's limit
            return too_long(self._most)
        return (
            Denied(error="an incomplete line isn't executed") if line and not line.endswith(b"\n") else line
        )

    def _take(self, request: Asked) -> None:
        order = request.what
        if isinstance(order, Denied):
            self._note(order.error)
            self._say(order, request.id)
            return
        try:
            reply = self._begun(order)
        except Trouble as trouble:
            self._say(denied(trouble), request.id)
            return
        if not asyncio.iscoroutine(reply):
            self._say(reply, request.id)
            return
        if len(self._carried_out) >= _MOST_WAITING:
            reply.close()
            self._say(Denied(error="too many orders are pending"), request.id)
            return
        task = asyncio.ensure_future(reply)
        self._carried_out.add(task)
        task.add_done_callback(lambda done: self._done(done, request.id))

    def _begun(self, order: Order[Any]) -> Any:
        """Begin to carry an order out. Return its reply, or an awaitable for the reply."""
        coordinator = self._coordinator
        if self._limits is not None and not isinstance(order, self._limits.allowed):
            error = f"{name_of(order)} isn't accepted at this port, which accepts {self._limits.said}"
            self._note(error)
            raise Trouble(error, code="")
        if isinstance(order, orders.Hello):
            if self._client is not None:
                raise Trouble(f"this connection already has the name {self._client.name}", code="")
            self._client = coordinator.attach(order.name)
            self._desk = Desk(coordinator, self._client)
            return welcome(coordinator, self._client)
        if self._client is None and not isinstance(order, _FOR_ANYBODY):
            raise Trouble('introduce the client first: {"order": "hello", "name": "..."}', code="")
        if isinstance(order, orders.Listen):
            self._listen(order)
            return Done()
        return self._desk.answer_now(order)

    def _note(self, error: str) -> None:
        """Log that an order was refused, if this connection may only send values."""
        if self._limits is not None:
            name = _NAMELESS if self._client is None else self._client.name
            self._coordinator.values.refused(name, error)

    def _listen(self, order: orders.Listen) -> None:
        if self._events is not None:
            self._events.close()
        self._events = self._coordinator.subscribe(
            CAPACITY, positions=order.positions, arrived=self._wanted.set
        )

    def _done(self, task: asyncio.Future[Any], id_: Id) -> None:
        self._carried_out.discard(task)
        if task.cancelled():
            return
        error = task.exception()
        if error is None:
            self._say(task.result(), id_)
        elif isinstance(error, Trouble):
            self._say(denied(error), id_)
        else:
            self._say(Denied(error=f"a bug of yarclang has ended this: {error!r}", help="report it"), id_)

    def _say(self, answer: Reply | Denied, id_: Id) -> None:
        """Send a reply, after all earlier events."""
        if self._events is not None:
            self._outgoing.extend(map(self._written.line, self._events.waiting()))
        self._outgoing.append(write_answer(answer, id_))
        if len(self._outgoing) > _MOST_UNREAD:
            self._writer.transport.abort()
        self._wanted.set()

    async def _write(self) -> None:
        """Write waiting replies and events, as fast as the caller reads them."""
        writer = self._writer
        try:
            while True:
                self._wanted.clear()
                if self._outgoing:
                    writer.write(self._outgoing.popleft())
                elif self._events is not None and (waiting := self._events.take()) is not None:
                    writer.write(self._written.line(waiting))
                else:
                    await self._wanted.wait()
                    continue
                await writer.drain()
        except ConnectionError:
            pass  # the caller has gone; the reader notices this as well

    async def _last_words(self, writing: asyncio.Task[None]) -> None:
        """Write the waiting lines to a caller that is being disconnected."""
        writing.cancel()
        while self._outgoing:
            self._writer.write(self._outgoing.popleft())

    def _leave(self) -> None:
        if self._events is not None:
            self._events.close()
        self._desk.stop_steering()
        if self._client is not None:
            self._client.session.leave()
        for task in tuple(self._carried_out):
            task.cancel()
