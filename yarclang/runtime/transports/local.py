"""Runs on this computer: the Unix socket by which other terminals reach a run.

It lies in a folder that only its owner may enter (`private.py`). Whoever may, may give orders: there is no password.
"""

from __future__ import annotations

import asyncio
import os
import re
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from types import TracebackType

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
from yarclang.runtime.transports.lock import Holder, holder_of, own_holders
from yarclang.runtime.transports.private import (
    MASTERS,
    ControlError,
    answers,
    check_private,
    folder,
    own_name,
    private_listener,
)

REPLY_TIME = 5.0
"""A run that takes longer to answer hangs [s]; a computer with much to do may need seconds."""

_LAST = 0.01
"""Within this time [s] whoever came last is let in: asyncio loses the connection of one that it lets in as a server closes."""

_POLL = 0.05
_NAME = re.compile(r"(?P<robot>.+)-(?P<pid>[0-9]{1,10})")


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
        self.path = place / f"{own_name(self._describe().robot.name)}.sock"
        wire = private_listener(self.path)
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


@dataclass(frozen=True, slots=True)
class Run:
    """A run on this computer: `name` as `industrial6-4711`, its robot and process, and its socket."""

    name: str
    robot: str
    pid: int
    path: Path


def find_runs() -> tuple[Run, ...]:
    """Return the runs of this user that are alive, in the order of their names.

    They are looked for in our own folder, and in those of runs that were begun where XDG_RUNTIME_DIR or TMPDIR is another one: each run tells who asks
    for its controller's lock.

    Raises:
        ControlError: our own folder isn't to be trusted.
    """
    place = folder()
    _remove_stale(place)
    return _alive({place, *(path for one in own_holders() if (path := _folder_of(one)) is not None)})


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
    """Return the run of this user that drives a controller, if there is one.

    Raises:
        ControlError: our own folder isn't to be trusted.
    """
    holder = holder_of(host, port)
    if holder is None or holder.peer is None or not holder.is_ours:
        return None
    places = {path for path in (folder(), _folder_of(holder)) if path is not None}
    return next((run for run in _alive(places) if run.pid == holder.peer.pid), None)


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


def _alive(places: set[Path]) -> tuple[Run, ...]:
    """Return the runs whose sockets lie in some folders, as far as they are alive."""
    found = {run.name: run for place in places for run in _runs_in(place) if answers(run.path)}
    return tuple(found[name] for name in sorted(found))


def _folder_of(holder: Holder) -> Path | None:
    """Return the folder of a run's socket, if it is ours alone."""
    if holder.folder is None:
        return None
    try:
        check_private(holder.folder)
    except ControlError:
        return None
    return holder.folder


def _runs_in(place: Path) -> list[Run]:
    """All sockets of a folder, alive or not."""
    named = [(path, _NAME.fullmatch(path.stem)) for path in sorted(place.glob("*.sock"))]
    return [Run(path.stem, name["robot"], int(name["pid"]), path) for path, name in named if name]


def _remove_stale(place: Path) -> None:
    """Remove the sockets of dead processes, also those that masters were to steer by."""
    for path in (*place.glob("*.sock"), *place.glob(f"*{MASTERS}")):
        named = _NAME.fullmatch(path.stem)
        try:
            if named is not None:
                os.kill(int(named["pid"]), 0)
        except (ProcessLookupError, OverflowError):
            path.unlink(missing_ok=True)
        except PermissionError:
            pass
