"""Servers through which another process steers the robot: a master arm that the robot follows, or a program
that sends velocities. The messages are in `messages/wants.py`.

The right to steer is checked before the first order is read. A Unix socket checks it by the permissions of
its file and the caller's user, a TCP port by a token.

Only one process steers at a time. A few callers that haven't proved their right yet may wait for a few
seconds. They can never displace the process that steers.
"""

from __future__ import annotations

import asyncio
import contextlib
import secrets
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders, wants
from yarclang.coordinator.messages.lines import denied, read_object, read_order, too_long, write_answer
from yarclang.coordinator.messages.replies import Denied, Done, Reply
from yarclang.files import reason_of
from yarclang.runtime.actions import Trouble
from yarclang.runtime.transports.private import MASTERS, folder, own_name, peer_of, private_listener

MOST_LINE = 1 << 14
"""Longest line [bytes]."""

LOOPBACK = "127.0.0.1"
"""Address of this computer that other computers can't reach."""

_TOKEN_BYTES = 32
"""Number of random bytes in a token."""

_UNREAD = 1 << 16
"""Largest number of bytes that a caller hasn't read yet. Beyond it, further replies to the caller are
dropped.
"""

_TAKEN = "another process already steers the robot"

_UNTOLD = 'the first line must be {"token": "..."}, with the token that yarc follow prints'


@dataclass(frozen=True, slots=True)
class UnixDoor:
    """A Unix socket that only processes of the same user and of root may use.

    Attributes:
        path: path of the socket's file; None: a new file in a folder that only its owner may enter.
    """

    path: Path | None = None


@dataclass(frozen=True, slots=True)
class TcpDoor:
    """A TCP port. All users of this computer can reach it, and so can every web page that is open on this
    computer. Therefore the first line of each connection must contain the token.

    Attributes:
        port: number of the port; 0: any free port.
        host: address on which to listen. If other computers can reach it, all messages can be read on the
            way, including the token.
        token: secret that is generated for each door.
    """

    port: int = 0
    host: str = LOOPBACK
    token: str = field(init=False, repr=False, default_factory=lambda: secrets.token_urlsafe(_TOKEN_BYTES))

    def opens_by(self, token: str) -> bool:
        """Return True if a token opens this door. The comparison takes constant time, and doesn't fail for
        any string that JSON can contain.
        """
        return secrets.compare_digest(_bytes(token), _bytes(self.token))


Door = UnixDoor | TcpDoor

DEFAULT_DOOR = UnixDoor()


@dataclass(frozen=True, slots=True)
class Patience:
    """Limits on the number of connections, and on how long a connection may stay silent.

    Attributes:
        first: longest time for the whole first line [s].
        silence: longest time for each further line [s].
        waiting: largest number of connections without a first line; a further connection closes the oldest
            one.
    """

    first: float = 5.0
    silence: float = 30.0
    waiting: int = 8


DEFAULT_PATIENCE = Patience()


class MasterServer:
    """Server for processes that steer the robot, one at a time. It listens until the context ends.

    The first order begins a live motion. The robot comes to rest after 200 ms without an order, after
    `finish`, or at the end of the connection. The next order begins another motion.

    Args:
        attached: the client that moves the robot; it must own the robot.
        door: address on which to listen, and the method by which callers prove their right to steer.
        robot: name of the robot, used for a socket's name.
        moving: frame to which poses and twists refer.
        speed: maximum speed of that frame [mm/s]; None: the robot's jog speed.
        patience: limits on the resources of connections.

    Attributes:
        port: port of a TCP door, once it listens.
        path: path of a Unix door's socket, once it listens.
    """

    def __init__(
        self,
        attached: Attached,
        door: Door = DEFAULT_DOOR,
        *,
        robot: str = "robot",
        moving: str = "{TCP}",
        speed: float | None = None,
        patience: Patience = DEFAULT_PATIENCE,
    ) -> None:
        self.door = door
        self.port = 0
        self.path: Path | None = None
        self._attached = attached
        self._robot = robot
        self._steer = orders.Steer(moving=moving, speed=speed)
        self._patience = patience
        self._server: asyncio.Server | None = None
        self._remove: Callable[[], None] = lambda: None
        self._steers: asyncio.StreamWriter | None = None
        self._waiting: dict[asyncio.Task[None], asyncio.StreamWriter] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    async def __aenter__(self) -> MasterServer:
        """Begin to listen.

        Raises:
            Trouble: the server can't listen on the address.
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
            reason = reason_of(error)
            raise Trouble(
                f"{door.host}:{door.port} can't be listened on: {reason}", "choose another port"
            ) from None
        self.port = self._server.sockets[0].getsockname()[1]

    async def _listen_unix(self, door: UnixDoor) -> None:
        self.path = door.path or folder() / f"{own_name(self._robot)}{MASTERS}"
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
                writer.write(_denied(error))
        except (ConnectionError, asyncio.CancelledError):
            pass  # the caller has gone, or is sent away
        finally:
            self._waiting.pop(task, None)
            self._tasks.discard(task)
            if writer.transport.get_write_buffer_size():
                writer.transport.abort()  # the caller doesn't read; closing would wait until it does
            else:
                writer.close()

    async def _meet(
        self, task: asyncio.Task[None], reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> str:
        """Check a caller's right to steer, then execute its orders.

        Returns:
            The reason why the connection ends; empty if the caller has ended it.
        """
        if isinstance(self.door, UnixDoor):
            if not peer_of(writer.get_extra_info("socket")).is_trusted:
                return "processes of other users can't steer the robot"
            if self._steers is not None:
                return _TAKEN
        if len(self._waiting) >= self._patience.waiting:
            oldest = next(iter(self._waiting))
            self._waiting.pop(oldest).write(_denied("too many processes are waiting to steer the robot"))
            oldest.cancel()
        self._waiting[task] = writer
        first = await line_within(reader, self._patience.first)
        if isinstance(first, Denied):
            return first.error
        if isinstance(self.door, TcpDoor) and first:
            token = token_in(first)
            if isinstance(token, Denied):
                return token.error
            if not self.door.opens_by(token):
                return "the token is wrong: yarc follow creates a new one at each start"
        del self._waiting[task]
        if not first:
            return ""
        if self._steers is not None:
            return _TAKEN
        self._steers = writer
        try:
            if isinstance(self.door, TcpDoor):
                writer.write(write_answer(Done()))
                first = b""
            return await self._serve(first, reader, writer)
        finally:
            self._steers = None

    async def _serve(self, line: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> str:
        """Carry out the orders of a caller, line by line. `line` is the first line, which was read already.
        Return the reason why the connection ends.
        """
        begun = False
        try:
            await self._attached.ask(self._steer)
            while True:
                read = line or await line_within(reader, self._patience.silence)
                line = b""
                if isinstance(read, Denied):
                    return read.error
                if not read:
                    return ""
                asked = read_order(read, MOST_LINE)
                if asked.ends and isinstance(asked.what, Denied):
                    return asked.what.error
                begun = True
                answer = write_answer(await self._answer(asked.what), asked.id)
                if writer.transport.get_write_buffer_size() < _UNREAD:
                    writer.write(answer)
                await asyncio.sleep(0)  # other tasks run after each line, even in a flood of lines
        except Trouble as trouble:
            return trouble.what
        finally:
            if begun:
                self._attached.send(orders.Leave())

    async def _answer(self, order: orders.Order[Any] | Denied) -> Reply | Denied:
        if isinstance(order, Denied):
            return order
        if not isinstance(order, wants.Want):
            return Denied(error="a master sends a target: joints, pose, velocity, twist or finish")
        try:
            return await self._attached.ask(order)
        except Trouble as trouble:
            return denied(trouble)


def _denied(error: str) -> bytes:
    return write_answer(Denied(error=error))


def token_in(line: bytes, untold: str = _UNTOLD) -> str | Denied:
    """Return the token that a line contains; otherwise a denial. If the line is a JSON object without a
    token, the denial has the text `untold`. No line raises an exception.
    """
    content = read_object(line, MOST_LINE)
    if isinstance(content, Denied):
        return content
    token = content.get("token")
    return token if len(content) == 1 and isinstance(token, str) else Denied(error=untold)


async def line_within(reader: asyncio.StreamReader, seconds: float) -> bytes | Denied:
    """Return the next line; empty at the end of the connection. An incomplete last line is ignored, so that
    an order isn't executed if its caller dies while writing it.

    Args:
        reader: reader of the connection.
        seconds: longest time for the whole line [s].
    """
    try:
        async with asyncio.timeout(seconds):
            line = await reader.readline()
    except ValueError:  # longer than the reader's limit
        return too_long(MOST_LINE)
    except TimeoutError:
        return Denied(error=f"no line was received for {seconds:g} s")
    return line if line.endswith(b"\n") else b""


def _bytes(token: str) -> bytes:
    """Return a token as bytes that can be compared in constant time."""
    return token.encode("utf-8", "surrogatepass")


def _remover(path: Path) -> Callable[[], None]:
    """Return a function that removes a socket's file, unless the file belongs to another socket by then."""
    status = path.lstat()

    def remove() -> None:
        with contextlib.suppress(OSError):
            found = path.lstat()
            if (found.st_dev, found.st_ino) == (status.st_dev, status.st_ino):
                path.unlink()

    return remove
