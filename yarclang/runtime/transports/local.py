"""Runs on this computer: a Unix socket by which other terminals reach a run, and a lock for each controller.

Both live in a folder that only its owner may enter. Whoever may, may give orders: there is no password.
"""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import os
import re
import socket
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from types import TracebackType

from yarclang.runtime.actions import Trouble
from yarclang.runtime.remote import (
    MOST_LINE,
    TOO_LONG,
    About,
    AskStatus,
    Denied,
    Reply,
    Request,
    Status,
    Taken,
    Watch,
    fulfilled,
    order_in,
    read_reply,
    read_request,
    write_reply,
    write_request,
)
from yarclang.runtime.session import Session

REPLY_TIME = 5.0
"""A run that takes longer to answer hangs [s]; a computer with much to do may need seconds."""

_LAST = 0.01
"""Within this time [s] whoever came last is let in: asyncio loses the connection of one that it lets in as a server closes."""

_ALIVE_TIME = 0.5
_POLL = 0.05
_NAME = re.compile(r"(?P<robot>.+)-(?P<pid>[0-9]{1,10})")


class ControlError(Trouble):
    """Something is the matter with a run's socket, its folder or its lock: what, and what to do about it."""


class ControlSocket:
    """Lets other terminals order and watch a session, as long as the context lasts.

    Nothing that a client does or leaves out keeps the session waiting: it is answered between two of the session's steps, and
    who doesn't read is not read either.

    Args:
        session: what is ordered.
        describe: what it is about; asked for each status.
    """

    def __init__(self, session: Session, describe: Callable[[], About]) -> None:
        self.path = Path()
        self._session = session
        self._describe = describe
        self._since = datetime.now().astimezone().isoformat(timespec="seconds")
        self._watch = Watch()
        session.listen(self._watch.hear)
        self._server: asyncio.Server | None = None
        self._clients: dict[asyncio.Task[None], asyncio.StreamWriter] = {}

    async def __aenter__(self) -> ControlSocket:
        """Listen.

        Raises:
            ControlError: nobody can be listened to here, and why.
        """
        place = folder()
        _remove_stale(place)
        self.path = place / f"{_file_name(self._describe().robot.name)}-{os.getpid()}.sock"
        wire = _listening(self.path)
        self._server = await asyncio.start_unix_server(self._accept, sock=wire, limit=MOST_LINE)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Send all away, and remove the socket."""
        self.path.unlink(missing_ok=True)
        await asyncio.sleep(_LAST)
        if self._server is not None:
            self._server.close()
        for client, writer in self._clients.items():
            client.cancel()
            writer.transport.abort()
        await asyncio.gather(*self._clients, return_exceptions=True)
        await asyncio.sleep(0)  # connections are closed one turn later

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        client = asyncio.get_running_loop().create_task(self._serve(reader, writer))
        self._clients[client] = writer
        client.add_done_callback(self._clients.pop)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """One client, to its end."""
        try:
            while line := await _line(reader):
                writer.write(write_reply(TOO_LONG if isinstance(line, Denied) else self._answer(line)))
                await writer.drain()
                if isinstance(line, Denied):
                    break
                await asyncio.sleep(0)  # who asks without end gets one answer a turn of the event loop
        except ConnectionError:
            pass  # it has gone
        finally:
            writer.close()

    def _answer(self, line: bytes) -> Reply:
        request = read_request(line)
        match request:
            case Denied():
                return request
            case AskStatus():
                return self._status()
        operation = self._session.operation
        order = order_in(request, operation)
        if isinstance(order, Denied):
            return order
        taken = Taken(operation.state)
        self._session.order(order)
        return taken

    def _status(self) -> Status:
        session = self._session
        controller = f"{session.host}:{session.port}"
        return self._watch.status(session.operation, self._describe(), controller, os.getpid(), self._since)


async def _line(reader: asyncio.StreamReader) -> bytes | Denied:
    """The next line; empty at the end."""
    try:
        return await reader.readline()
    except ValueError:  # longer than the reader's limit
        return TOO_LONG


def _listening(path: Path) -> socket.socket:
    """A socket that listens, for its owner alone.

    Raises:
        ControlError: it can't.
    """
    if _answers(path):
        raise ControlError(f"this process has a control socket already: {path}")
    wire = socket.socket(socket.AF_UNIX)
    try:
        path.unlink(missing_ok=True)  # of a dead process that had our number
        os.fchmod(wire.fileno(), 0o600)  # the file gets the rights that the socket has
        wire.bind(str(path))
        wire.listen()
    except OSError as error:
        wire.close()
        raise ControlError(f"{path} can't be listened on: {_reason(error)}") from None
    return wire


@contextlib.contextmanager
def controller_lock(host: str, port: int) -> Iterator[None]:
    """Keep other runs on this computer, of this user, from a controller as long as the context lasts.

    The kernel gives the lock back when the process dies, however it does.

    Args:
        host: of the controller; its other names are the same controller.
        port: likewise.

    Raises:
        ControlError: somebody else has it.
    """
    path = folder() / _lock_file(host, port)
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        raise ControlError(f"{path} can't be opened: {_reason(error)}") from None
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            who = f"process {pid}" if (pid := _pid_in(path)) else "a process"
            raise ControlError(
                f"{who} on this computer drives {host}:{port} already", "wait for its end, or `yarc stop` it"
            ) from None
        os.ftruncate(handle, 0)
        os.write(handle, b"%d\n" % os.getpid())
        try:
            yield
        finally:
            os.ftruncate(handle, 0)
    finally:
        os.close(handle)


@dataclass(frozen=True, slots=True)
class Run:
    """A run on this computer: `name` as `industrial6-4711`, its robot and process, and its socket."""

    name: str
    robot: str
    pid: int
    path: Path


def find_runs() -> tuple[Run, ...]:
    """The runs of this user that are alive, in order of their names.

    Raises:
        ControlError: their folder isn't to be trusted.
    """
    place = folder()
    _remove_stale(place)
    return tuple(run for run in _runs_in(place) if _answers(run.path))


def the_run(name: str | None = None) -> Run:
    """The only run, or that with a name: the whole of it, its robot, or the number of its process.

    Raises:
        ControlError: there is none, or several.
    """
    runs = find_runs()
    if not runs:
        raise ControlError(
            "no yarc run on this computer", "a controller can be asked itself: --to tcp://HOST:PORT"
        )
    fitting = [
        run for run in runs if name is None or name.lower() in (run.name.lower(), run.robot, str(run.pid))
    ]
    if len(fitting) == 1:
        return fitting[0]
    names = ", ".join(run.name for run in fitting or runs)
    if not fitting:
        raise ControlError(f"there is no run {name!r}", f"there is {names}")
    raise ControlError(f"there are several runs: {names}", "say which: --run NAME")


def run_on(host: str, port: int) -> Run | None:
    """The run that drives a controller, if one of this computer does.

    Raises:
        ControlError: the runs' folder isn't to be trusted.
    """
    pid = _pid_in(folder() / _lock_file(host, port))
    return next((run for run in find_runs() if run.pid == pid), None)


class GoneError(ControlError):
    """There is no run behind a socket any more."""


def send(run: Run, request: Request, timeout: float = REPLY_TIME) -> Taken | Status:
    """Ask a run something.

    Raises:
        GoneError: it has ended.
        ControlError: it doesn't answer within `timeout` [s], or denies it.
    """
    try:
        with socket.socket(socket.AF_UNIX) as wire:
            wire.settimeout(timeout)
            wire.connect(str(run.path))
            wire.sendall(write_request(request))
            with wire.makefile("rb") as lines:
                line = lines.readline(MOST_LINE + 1)
    except (TimeoutError, BlockingIOError):  # nobody accepts, and many wait
        raise ControlError(
            f"{run.name} doesn't answer within {timeout:g} s",
            "its guard PLC holds when the buffer runs low; `yarc stop --to ...` asks the controller itself",
        ) from None
    except OSError:
        line = b""
    if not line:
        raise GoneError(f"{run.name} has ended")
    reply = read_reply(line)
    if isinstance(reply, Denied):
        raise ControlError(f"{run.name}: {reply.error}")
    return reply


def status_of(run: Run) -> Status:
    """How a run is going.

    Raises:
        GoneError, ControlError: as `send`.
    """
    reply = send(run, AskStatus())
    if not isinstance(reply, Status):
        raise ControlError(f"{run.name} doesn't say how it is going")
    return reply


def order(run: Run, request: Request, patience: float) -> Status | None:
    """Order something, and wait until it is so.

    Returns:
        How the run is going then; None if it has ended since it took the order.

    Raises:
        GoneError: it had ended before.
        ControlError: it doesn't answer, denies it, or it isn't so after `patience` [s].
    """
    send(run, request)
    until = time.monotonic() + patience
    while True:
        try:
            status = status_of(run)
        except GoneError:
            return None
        if fulfilled(request, status):
            return status
        if time.monotonic() > until:
            raise ControlError(
                f"{run.name} has taken the order, but after {patience:g} s its state is still {status.state.value}",
                "`yarc status` tells more",
            )
        time.sleep(_POLL)


def folder() -> Path:
    """Where sockets and locks live: made where it is missing.

    Raises:
        ControlError: it isn't ours alone.
    """
    given = Path(os.environ.get("XDG_RUNTIME_DIR", ""))
    if given.is_absolute() and given.is_dir():
        path = given / "yarc"
    else:
        path = Path(tempfile.gettempdir()) / f"yarc-{os.getuid()}"
    try:
        with contextlib.suppress(FileExistsError):
            path.mkdir(0o700)
        found = path.lstat()
    except OSError as error:
        raise ControlError(f"{path} can't be made: {_reason(error)}") from None
    if not path.is_dir() or path.is_symlink():
        raise ControlError(f"{path} isn't a folder", "remove it")
    if found.st_uid != os.getuid():
        raise ControlError(f"{path} belongs to user {found.st_uid}", "have it removed")
    if found.st_mode & 0o077:
        raise ControlError(
            f"others may enter {path}", f"`chmod 700 {path}`, if nobody else's files are in it"
        )
    return path


def _runs_in(place: Path) -> list[Run]:
    """All sockets of a folder, alive or not."""
    named = [(path, _NAME.fullmatch(path.stem)) for path in sorted(place.glob("*.sock"))]
    return [Run(path.stem, name["robot"], int(name["pid"]), path) for path, name in named if name]


def _remove_stale(place: Path) -> None:
    """Remove the sockets of dead processes."""
    for run in _runs_in(place):
        try:
            os.kill(run.pid, 0)
        except (ProcessLookupError, OverflowError):
            run.path.unlink(missing_ok=True)
        except PermissionError:
            pass


def _answers(path: Path) -> bool:
    """Whether somebody listens."""
    with socket.socket(socket.AF_UNIX) as wire:
        wire.settimeout(_ALIVE_TIME)
        try:
            wire.connect(str(path))
        except BlockingIOError:  # it hangs, and many wait
            return True
        except OSError:
            return False
    return True


def _lock_file(host: str, port: int) -> str:
    """One file for all names of a controller."""
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        # addresses are in order of their kind, then of their text: localhost is 127.0.0.1 and not ::1
        host = str(min((int(family), str(address[0])) for family, _, _, _, address in found)[1])
    except (OSError, UnicodeError):
        pass  # nobody can connect to it either
    return f"{_file_name(host)}-{port}.lock"


def _file_name(text: str) -> str:
    return re.sub(r"[^a-z0-9_.]+", "_", text.lower())


def _pid_in(path: Path) -> int | None:
    """The process that a lock's file names."""
    try:
        return int(path.read_text())
    except (OSError, ValueError):
        return None


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
