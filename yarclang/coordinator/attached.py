"""A client's connection to a coordinator, in the same process or through a socket. The client sends orders,
and receives replies and events.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any, Protocol, TypeVar

from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.desk import Desk, welcome
from yarclang.coordinator.mailbox import CAPACITY
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.lines import (
    MOST_ANSWER,
    read_answer,
    read_event,
    read_object,
    write_order,
)
from yarclang.coordinator.messages.orders import Order
from yarclang.coordinator.messages.replies import Denied, Reply, Welcome
from yarclang.coordinator.subscription import Subscription
from yarclang.files import reason_of
from yarclang.runtime.actions import Trouble

R = TypeVar("R", bound=Reply)
_PATIENCE = 5.0
"""Longest wait for the coordinator's first message [s]."""

Refused = Callable[[Trouble], object]


class Attached(Protocol):
    """A client of a coordinator.

    Attributes:
        welcome: the coordinator's first message.
    """

    welcome: Welcome

    @property
    def silence(self) -> float:
        """Return the time since the coordinator's last message [s]. While a robot is connected, the
        coordinator reports its position many times a second, so a long silence means that the coordinator
        doesn't respond.
        """
        ...

    async def ask(self, order: Order[R]) -> R:
        """Send an order, and wait for the reply.

        Raises:
            Trouble: the order was denied, or the coordinator has gone.
        """
        ...

    def send(self, order: Order[Any], refused: Refused | None = None) -> None:
        """Send an order and return without waiting for the reply.

        Args:
            order: the order.
            refused: called with the refusal if the order is denied.
        """
        ...

    async def listen(self, *, positions: bool = True, capacity: int = CAPACITY) -> Subscription:
        """Return an iterator over all events from now on."""
        ...

    async def leave(self) -> None:
        """Stop being a client. If this client owned the robot, the robot comes to rest on its path."""
        ...


class Here:
    """Client in the coordinator's own process.

    Args:
        coordinator: the robot's coordinator.
        name: name of the client that others see.

    Attributes:
        desk: carries out the orders.
        client: the client itself.
    """

    def __init__(self, coordinator: Coordinator, name: str) -> None:
        self._coordinator = coordinator
        self.client = coordinator.attach(name)
        self.desk = Desk(coordinator, self.client)
        self.welcome = welcome(coordinator, self.client)

    @property
    def silence(self) -> float:
        """Return 0: a coordinator in this process is always reachable."""
        return 0.0

    async def ask(self, order: Order[R]) -> R:
        """Send an order and wait for the reply. See `Attached.ask`."""
        return await self.desk.answer(order)

    def send(self, order: Order[Any], refused: Refused | None = None) -> None:
        """Send an order and return without waiting for the reply. See `Attached.send`."""
        try:
            reply = self.desk.answer_now(order)
        except Trouble as trouble:
            if refused is not None:
                refused(trouble)
            return
        if asyncio.iscoroutine(reply):
            task = asyncio.ensure_future(reply)
            task.add_done_callback(lambda done: _ended(done, refused))

    async def listen(self, *, positions: bool = True, capacity: int = CAPACITY) -> Subscription:
        """Return an iterator over all events from now on. See `Attached.listen`."""
        return self._coordinator.subscribe(capacity, positions=positions)

    def give_up(self) -> None:
        """End at once even if the robot can't be reached. The robot's state is then unknown."""
        self._coordinator.give_up()

    async def leave(self) -> None:
        """Stop being a client. See `Attached.leave`."""
        self.desk.stop_steering()
        self.client.session.leave()


def _ended(task: asyncio.Future[Any], refused: Refused | None) -> None:
    if task.cancelled():
        return
    error = task.exception()
    if isinstance(error, Trouble) and refused is not None:
        refused(error)


class There:
    """A client of a coordinator in another process. Use `attach` to create one.

    Args:
        path: path of the coordinator's socket.
        reader, writer: streams of the connection.
    """

    welcome: Welcome

    def __init__(self, path: Path, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.path = path
        self._reader = reader
        self._writer = writer
        self._numbers = count(1)
        self._asked: dict[int, tuple[type[Reply], asyncio.Future[Any]]] = {}
        self._listeners: list[Subscription] = []
        self._loop = asyncio.get_running_loop()
        self._heard = self._loop.time()
        self._hearing = self._loop.create_task(self._hear(), name="attached")

    @classmethod
    async def attach(cls, path: Path, name: str) -> There:
        """Become a client of the coordinator that listens on a socket.

        Raises:
            Trouble: no coordinator listens on the socket, or it has another version of the protocol.
        """
        try:
            reader, writer = await asyncio.open_unix_connection(str(path), limit=MOST_ANSWER)
        except OSError as error:
            reason = reason_of(error)
            raise Trouble(f"{path.stem} can't be reached: {reason}", "has it ended?", "Y1606") from None
        client = cls(path, reader, writer)
        try:
            async with asyncio.timeout(_PATIENCE):
                client.welcome = await client.ask(orders.Hello(name=name))
        except TimeoutError:
            await client.leave()
            what = f"{path.stem} doesn't answer within {_PATIENCE:g} s"
            raise Trouble(what, "check whether its process hangs", "Y1606") from None
        except Trouble:
            await client.leave()
            raise
        return client

    @property
    def silence(self) -> float:
        """Return the time since the last message of the coordinator [s]."""
        return self._loop.time() - self._heard

    @property
    def is_gone(self) -> bool:
        """Return True if the connection has ended."""
        return self._hearing.done() or self._writer.is_closing()

    async def ask(self, order: Order[R]) -> R:
        """Send an order and wait for the reply. See `Attached.ask`."""
        answer: R = await self._send(order)
        return answer

    def send(self, order: Order[Any], refused: Refused | None = None) -> None:
        """Send an order and return without waiting for the reply. See `Attached.send`."""
        try:
            future = self._send(order)
        except Trouble as trouble:
            if refused is not None:
                refused(trouble)
            return
        future.add_done_callback(lambda done: _ended(done, refused))

    async def listen(self, *, positions: bool = True, capacity: int = CAPACITY) -> Subscription:
        """Return an iterator over all events from now on. See `Attached.listen`."""
        one = Subscription(capacity, self._listeners.remove)
        self._listeners.append(one)
        await self.ask(orders.Listen(positions=positions))
        return one

    async def leave(self) -> None:
        """Stop being a client. See `Attached.leave`."""
        self._writer.close()
        self._hearing.cancel()
        with contextlib.suppress(asyncio.CancelledError, OSError):
            await self._hearing

    def _send(self, order: Order[Any]) -> asyncio.Future[Any]:
        if self.is_gone:
            raise self._has_ended()
        number = next(self._numbers)
        future = self._loop.create_future()
        self._asked[number] = (order.answer, future)
        self._writer.write(write_order(order, number))
        return future

    async def _hear(self) -> None:
        try:
            while line := await self._reader.readline():
                self._heard = self._loop.time()
                self._take(line)
        except (OSError, ValueError):  # the coordinator has gone, or sends something unknown
            pass
        finally:
            for _, future in self._asked.values():
                if not future.done():
                    future.set_exception(self._has_ended())
            self._asked.clear()
            for one in tuple(self._listeners):
                one.close()

    def _take(self, line: bytes) -> None:
        content = read_object(line)
        if isinstance(content, Denied):
            return
        if "event" in content:
            event = read_event(content)
            if event is not None:
                for one in tuple(self._listeners):
                    one.put(event)
            return
        number = content.get("id")
        kind, future = self._asked.pop(number, (Reply, None)) if isinstance(number, int) else (Reply, None)
        if future is None or future.done():
            return
        answer = read_answer(content, kind)
        if isinstance(answer, Denied):
            future.set_exception(Trouble(answer.error, answer.help or "", answer.code or ""))
        else:
            future.set_result(answer)

    def _has_ended(self) -> Trouble:
        return Trouble(
            f"{self.path.stem} has ended", "if it was killed, its robot comes to rest: inspect it", "Y1606"
        )
