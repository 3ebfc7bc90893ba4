"""Lets another process steer the robot over TCP (`wire.py`): the paper's master and slave, and velocities from elsewhere."""

from __future__ import annotations

import asyncio
from types import TracebackType
from typing import TYPE_CHECKING

from yarclang.coordinator.live.drive import Drive
from yarclang.coordinator.live.opening import Settings
from yarclang.coordinator.live.steering import Master, Target
from yarclang.coordinator.live.wire import MOST_LINE, Denied, Finish, Reader, write_denied, write_taken
from yarclang.runtime.actions import Trouble

if TYPE_CHECKING:
    from yarclang.coordinator.client import Client

LOOPBACK = "127.0.0.1"
"""Where it listens unless somebody says otherwise: nobody else can reach it."""

_UNREAD = 1 << 16
"""Answers that nobody reads [bytes]: no more are written then."""


class MasterServer:
    """Listens as long as the context lasts; one process at a time steers. The client must own the robot.

    The first message begins a live motion; 200 ms without one, `finish`, or the end of the connection bring it to rest. The next message begins another.

    Args:
        client: who moves the robot.
        port: to listen on; 0 takes any that is free, and `port` tells which.
        host: likewise.
        moving: the frame whose poses and twists are meant.
        settings: how fast at most.
    """

    def __init__(
        self,
        client: Client,
        port: int = 0,
        *,
        host: str = LOOPBACK,
        moving: str = "{TCP}",
        settings: Settings | None = None,
    ) -> None:
        self.port = port
        self._client = client
        self._host = host
        self._moving = moving
        self._settings = settings or Settings()
        self._server: asyncio.Server | None = None
        self._steers: asyncio.StreamWriter | None = None
        self._tasks: set[asyncio.Task[None]] = set()

    async def __aenter__(self) -> MasterServer:
        """Listen.

        Raises:
            Trouble: the address can't be listened on.
        """
        try:
            self._server = await asyncio.start_server(self._accept, self._host, self.port, limit=MOST_LINE)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise Trouble(
                f"{self._host}:{self.port} can't be listened on: {reason}", "choose another port"
            ) from None
        self.port = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
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
            if self._steers is not None:
                writer.write(write_denied("another process steers the robot"))
                return
            self._steers = writer
            await self._serve(reader, writer)
        except (ConnectionError, asyncio.CancelledError):
            pass  # it has gone, or is sent away
        finally:
            if self._steers is writer:
                self._steers = None
            writer.close()
            self._tasks.discard(task)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        found = await self._client.frame(self._moving)
        if found.value is None:
            writer.write(write_denied(found.diagnostics[0].message))
            return
        steered = _Steered(self._client, self._moving, self._settings)
        try:
            meaning = Reader(self._client.robot, found.value, await self._client.stands())
            while line := await _line(reader):
                wanted = meaning.read(line, asyncio.get_running_loop().time())
                answer = await steered.take(wanted)
                if writer.transport.get_write_buffer_size() < _UNREAD:
                    writer.write(answer)
        except Trouble as trouble:
            writer.write(write_denied(trouble.what))
        finally:
            steered.stop()


class _Steered:
    """The live motion of one connection, when there is one."""

    def __init__(self, client: Client, moving: str, settings: Settings) -> None:
        self._client = client
        self._moving = moving
        self._settings = settings
        self._drive: Drive | None = None

    async def take(self, wanted: Target | Finish | Denied) -> bytes:
        """Do what a message says; the answer."""
        if isinstance(wanted, Denied):
            return write_denied(wanted.error)
        if isinstance(wanted, Finish):
            if self._drive is not None and self._drive.alive:
                self._drive.finish()
            return write_taken(self._client.robot, 0.0, None, "")
        try:
            drive = await self._driven(wanted)
        except Trouble as trouble:
            return write_denied(trouble.what)
        if isinstance(drive, str):
            return write_denied(drive)
        behind = wanted.q - drive.end if isinstance(wanted, Master) else None
        return write_taken(self._client.robot, drive.lag, behind, drive.why)

    async def _driven(self, target: Target) -> Drive | str:
        if self._drive is not None and self._drive.alive:
            self._drive.want(target)
            return self._drive
        made = await self._client.drive(target, moving=self._moving, settings=self._settings, name="master")
        if made.value is None:
            return made.diagnostics[0].message
        self._drive = made.value
        return self._drive

    def stop(self) -> None:
        """The connection has ended."""
        if self._drive is not None:
            self._drive.stop()


async def _line(reader: asyncio.StreamReader) -> bytes:
    """The next line; empty at the end, and where one is too long: what comes behind it can't be read either."""
    try:
        return await reader.readline()
    except ValueError:
        return b""
