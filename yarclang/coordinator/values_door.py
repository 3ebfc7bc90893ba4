"""A TCP port through which a camera, a PLC gateway or a script can send register values to the running
program. All other orders are refused.

A token is checked before the first order is read. The messages are those of the coordinator (`messages/`),
one JSON object per line.
"""

from __future__ import annotations

import asyncio
from types import TracebackType

from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.live.serving import Patience, TcpDoor, line_within, token_in
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.lines import write_answer
from yarclang.coordinator.messages.replies import Denied, Done
from yarclang.coordinator.serving import Limits, Visitor, Written
from yarclang.files import reason_of
from yarclang.runtime.actions import Trouble

_MOST_LINE = 1 << 14
"""Longest line [bytes]."""

_MOST_CLIENTS = 8
"""Largest number of connections that have sent the token."""

_LIMITS = Limits(
    (orders.Hello, orders.AskStatus, orders.Listen, orders.Fill), "hello, status, listen and fill", _MOST_LINE
)

_UNTOLD = 'the first line must be {"token": "..."}, with the token that yarc serve has written'


class ValuesDoor:
    """Server that receives register values for the running program. It listens until the context ends.

    Args:
        coordinator: the coordinator.
        door: address on which to listen, and the token.
        patience: limits for connections that haven't sent the token.

    Attributes:
        port: port, once it listens.
    """

    def __init__(self, coordinator: Coordinator, door: TcpDoor, *, patience: Patience | None = None) -> None:
        self.door = door
        self.port = 0
        self._coordinator = coordinator
        self._patience = patience or Patience()
        self._server: asyncio.Server | None = None
        self._written = Written()
        self._waiting: dict[asyncio.Task[None], asyncio.StreamWriter] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._let_in = 0

    async def __aenter__(self) -> ValuesDoor:
        """Begin to listen.

        Raises:
            Trouble: the server can't listen on the address.
        """
        door = self.door
        try:
            self._server = await asyncio.start_server(self._accept, door.host, door.port, limit=_MOST_LINE)
        except OSError as error:
            raise Trouble(
                f"{door.host}:{door.port} can't be listened on: {reason_of(error)}", "choose another port"
            ) from None
        self.port = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Disconnect all callers."""
        assert self._server is not None
        self._server.close()
        for task in tuple(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._tasks.add(task)
        try:
            error = await self._meet(task, reader, writer)
            if error:
                writer.write(write_answer(Denied(error=error)))
        except (ConnectionError, asyncio.CancelledError):
            pass  # the caller has gone, or is sent away
        finally:
            self._waiting.pop(task, None)
            self._tasks.discard(task)
            if writer.transport.get_write_buffer_size():
                writer.transport.abort()  # the caller doesn't read; closing would wait for that
            else:
                writer.close()

    async def _meet(
        self, task: asyncio.Task[None], reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> str:
        """Check a caller's right to send values, then accept its values. Return the reason why the connection
        ends; empty if the caller has ended it.
        """
        if len(self._waiting) >= self._patience.waiting:
            oldest = next(iter(self._waiting))
            self._waiting.pop(oldest).write(write_answer(Denied(error="too many connections are waiting")))
            oldest.cancel()
        self._waiting[task] = writer
        first = await line_within(reader, self._patience.first)
        if isinstance(first, Denied):
            return first.error
        if not first:
            return ""
        token = token_in(first, _UNTOLD)
        if isinstance(token, Denied):
            return token.error
        if not self.door.opens_by(token):
            return "the token is wrong: yarc serve creates a new one at each start"
        if self._let_in >= _MOST_CLIENTS:
            return f"{_MOST_CLIENTS} connections send values already"
        del self._waiting[task]
        writer.write(write_answer(Done()))
        self._let_in += 1
        try:
            await Visitor(self._coordinator, reader, writer, self._written, _LIMITS).serve()
        finally:
            self._let_in -= 1
        return ""
