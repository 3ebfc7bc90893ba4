"""Lets another process steer the robot (`wire.py`): the paper's master and slave, and velocities from elsewhere.

Who may steer is settled before the first order is read: by the rights of a Unix socket's file and by the caller's user, or, over TCP, by a token. A process that hasn't
shown that it may steer costs a place among a few that wait, for a few seconds, and never the place of the one that steers.
"""

from __future__ import annotations

import asyncio
import contextlib
import secrets
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from yarclang.coordinator.live.drive import Drive
from yarclang.coordinator.live.opening import Settings
from yarclang.coordinator.live.steering import Master, Target
from yarclang.coordinator.live.wire import (
    MOST_LINE,
    TOO_LONG,
    Denied,
    Finish,
    Reader,
    read_token,
    write_denied,
    write_taken,
    write_welcome,
)
from yarclang.runtime.actions import Trouble
from yarclang.runtime.transports.private import MASTERS, folder, own_name, peer_of, private_listener

if TYPE_CHECKING:
    from yarclang.coordinator.client import Client

LOOPBACK = "127.0.0.1"
"""Address of this computer that no other computer reaches."""

_TOKEN_BYTES = 32
"""Random bytes of a token."""

_UNREAD = 1 << 16
"""Answers that nobody reads [bytes]: no more are written then."""

_TAKEN = "another process steers the robot"


@dataclass(frozen=True, slots=True)
class UnixDoor:
    """A Unix socket that only processes of our own user, and root, may use.

    Attributes:
        path: of its file; None: a new one in the folder that only its owner may enter.
    """

    path: Path | None = None


@dataclass(frozen=True, slots=True)
class TcpDoor:
    """A TCP port. All users of this computer reach it, and each web page that is open here, so the first line must have the token.

    Attributes:
        port: 0 takes any that is free.
        host: address to listen on. Beyond this computer, all that is said can be read on the way, the token too.
        token: made anew for each door.
    """

    port: int = 0
    host: str = LOOPBACK
    token: str = field(init=False, repr=False, default_factory=lambda: secrets.token_urlsafe(_TOKEN_BYTES))


Door = UnixDoor | TcpDoor

DEFAULT_DOOR = UnixDoor()


@dataclass(frozen=True, slots=True)
class Patience:
    """Bounds of what connections may cost.

    Attributes:
        first: time for the whole of the first line [s].
        silence: time for each further one [s].
        waiting: connections that haven't said their first line; one more ends the oldest.
    """

    first: float = 5.0
    silence: float = 30.0
    waiting: int = 8


DEFAULT_PATIENCE = Patience()


class MasterServer:
    """Listens as long as the context lasts; one process at a time steers. The client must own the robot.

    The first order begins a live motion; 200 ms without one, `finish`, or the end of the connection bring it to rest. The next order begins another.

    Args:
        client: moves the robot.
        door: where to listen, and how callers show that they may steer.
        moving: the frame whose poses and twists are meant.
        settings: how fast at most.
        patience: what connections may cost.

    Attributes:
        port: of a TCP door, once it listens.
        path: of a Unix door's socket, once it listens.
    """

    def __init__(
        self,
        client: Client,
        door: Door = DEFAULT_DOOR,
        *,
        moving: str = "{TCP}",
        settings: Settings | None = None,
        patience: Patience = DEFAULT_PATIENCE,
    ) -> None:
        self.door = door
        self.port = 0
        self.path: Path | None = None
        self._client = client
        self._moving = moving
        self._settings = settings or Settings()
        self._patience = patience
        self._server: asyncio.Server | None = None
        self._remove: Callable[[], None] = lambda: None
        self._steers: asyncio.StreamWriter | None = None
        self._waiting: dict[asyncio.Task[None], asyncio.StreamWriter] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    async def __aenter__(self) -> MasterServer:
        """Listen.

        Raises:
            Trouble: the address can't be listened on.
        """
        if isinstance(self.door, TcpDoor):
            await self._listen_tcp(self.door)
        else:
            await self._listen_unix(self.door)
        return self

    async def _listen_tcp(self, door: TcpDoor) -> None:
        try:
            self._server = await asyncio.start_server(self._accept, door.host, door.port, limit=MOST_LINE)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise Trouble(
                f"{door.host}:{door.port} can't be listened on: {reason}", "choose another port"
            ) from None
        self.port = self._server.sockets[0].getsockname()[1]

    async def _listen_unix(self, door: UnixDoor) -> None:
        self.path = door.path or folder() / f"{own_name(self._client.robot.name)}{MASTERS}"
        wire = private_listener(self.path)
        self._remove = _remover(self.path)
        self._server = await asyncio.start_unix_server(self._accept, sock=wire, limit=MOST_LINE)

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self._server is not None
        self._remove()
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
                writer.write(write_denied(error))
        except (ConnectionError, asyncio.CancelledError):
            pass  # it has gone, or is sent away
        finally:
            self._waiting.pop(task, None)
            self._tasks.discard(task)
            if writer.transport.get_write_buffer_size():
                writer.transport.abort()  # the caller doesn't read, and closing would wait for that
            else:
                writer.close()

    async def _meet(
        self, task: asyncio.Task[None], reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> str:
        """Let a caller show that it may steer, and then steer.

        Returns:
            Why the connection ends; empty if the caller ends it.
        """
        if isinstance(self.door, UnixDoor):
            if not peer_of(writer.get_extra_info("socket")).is_trusted:
                return "processes of other users can't steer the robot"
            if self._steers is not None:
                return _TAKEN
        if len(self._waiting) >= self._patience.waiting:
            oldest = next(iter(self._waiting))
            self._waiting.pop(oldest).write(write_denied("too many processes wait to steer the robot"))
            oldest.cancel()
        self._waiting[task] = writer
        first = await _line(reader, self._patience.first)
        if isinstance(first, Denied):
            return first.error
        if isinstance(self.door, TcpDoor) and first:
            token = read_token(first)
            if isinstance(token, Denied):
                return token.error
            if not secrets.compare_digest(_bytes(token), _bytes(self.door.token)):
                return "the token is wrong: yarc follow gives another one each time that it begins"
        del self._waiting[task]
        if not first:
            return ""
        if self._steers is not None:
            return _TAKEN
        self._steers = writer
        try:
            if isinstance(self.door, TcpDoor):
                writer.write(write_welcome())
                first = b""
            return await self._serve(first, reader, writer)
        finally:
            self._steers = None

    async def _serve(self, line: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> str:
        """Do what a caller's lines say, a first one that was read already included; why the connection ends."""
        found = await self._client.frame(self._moving)
        if found.value is None:
            return found.diagnostics[0].message
        steered = _Steered(self._client, self._moving, self._settings)
        try:
            meaning = Reader(self._client.robot, found.value, await self._client.stands())
            while True:
                read = line or await _line(reader, self._patience.silence)
                line = b""
                if isinstance(read, Denied):
                    return read.error
                if not read:
                    return ""
                wanted = meaning.read(read, asyncio.get_running_loop().time())
                if isinstance(wanted, Denied) and wanted.ends:
                    return wanted.error
                answer = await steered.take(wanted)
                if writer.transport.get_write_buffer_size() < _UNREAD:
                    writer.write(answer)
                await asyncio.sleep(0)  # lines without end get one turn of the event loop each
        except Trouble as trouble:
            return trouble.what
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


async def _line(reader: asyncio.StreamReader, seconds: float) -> bytes | Denied:
    """Return the next line; empty at the end, also after half a line: a caller that dies within one has ordered nothing.

    Args:
        reader: of the connection.
        seconds: for the whole line.
    """
    try:
        async with asyncio.timeout(seconds):
            line = await reader.readline()
    except ValueError:  # longer than the reader's limit
        return TOO_LONG
    except TimeoutError:
        return Denied(f"nothing was said for {seconds:g} s", ends=True)
    return line if line.endswith(b"\n") else b""


def _bytes(token: str) -> bytes:
    """Return a token as what can be compared in constant time, whatever JSON makes a string of."""
    return token.encode("utf-8", "surrogatepass")


def _remover(path: Path) -> Callable[[], None]:
    """Return what removes a socket's file, unless it is that of another socket by then."""
    made = path.lstat()

    def remove() -> None:
        with contextlib.suppress(OSError):
            found = path.lstat()
            if (found.st_dev, found.st_ino) == (made.st_dev, made.st_ino):
                path.unlink()

    return remove
