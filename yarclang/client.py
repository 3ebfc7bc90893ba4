"""Order, ask and watch a robot that yarclang drives: one file without other imports than the standard library's, to be copied or imported.

A process that owns a robot (`yarc serve`, `run`, `exec`, `repl`, `follow`) listens on a Unix socket of its user. One JSON object a line goes there, and one
comes back; docs/coordinator.md of yarclang lists them all.

    from yarclang.client import Robot

    with Robot("industrial6", name="my cell") as robot:
        robot.own()
        offer = robot.offer("MOVEJ 10 0 0 0 20 0 [2] (deg,s)")
        print(offer["offer"]["duration_s"])
        print(robot.go(offer["offer"]["number"])["well"])
        for event in robot.events():
            print(event)

Written for Python 3.8 and later. Each `Robot` is for one thread; `order`, `stop`, `hold`, `abort` and `close` may be called from any.
"""

from __future__ import annotations

import collections
import contextlib
import json
import os
import re
import socket
import stat
import tempfile
import threading
import time
from pathlib import Path
from types import TracebackType
from typing import Any, Dict, Iterator, NamedTuple

VERSION = 1
"""Of the protocol."""

REPLY_TIME = 5.0
"""Whoever takes longer to answer what needs no motion hangs [s]; a computer with much to do may need seconds."""

_LONGEST = 1 << 26
"""Longest line of an answer [bytes]."""

_NOT_UNDERSTOOD = "what comes back isn't understood: is it another version of yarc?"

_NAME = re.compile(r"(?P<robot>.+)-(?P<pid>[0-9]{1,10})\.sock")

_TCP = re.compile(r"tcp://\[?(?P<host>[^\]]+)\]?:(?P<port>[0-9]{1,5})")

_LATE = (socket.timeout, BlockingIOError)
"""What a socket says of somebody who doesn't answer, and of one whom many wait for."""

Message = Dict[str, Any]


class Refused(Exception):  # noqa: N818  (what a reply says)
    """An order was denied: what is the matter, what to do about it, and the code of the finding that it is, if it is one."""

    def __init__(self, error: str, help_: str = "", code: str = "") -> None:
        super().__init__(error)
        self.error = error
        self.help = help_
        self.code = code


class Gone(Exception):  # noqa: N818
    """Nobody is there, or nobody is there any more."""


class Found(NamedTuple):
    """A process that owns a robot: its name, as `industrial6-4711`, the robot's, the process's number, and its socket."""

    name: str
    robot: str
    pid: int
    path: str


def find(folder: str | None = None) -> list[Found]:
    """Return the processes of this user that own robots, by the sockets in a folder (None: the user's own), in the order of their names."""
    found = []
    place = Path(folder or runtime_folder())
    with contextlib.suppress(OSError):
        for path in sorted(place.glob("*.sock")):
            named = _NAME.fullmatch(path.name)
            if named is not None and _answers(str(path)):
                found.append(Found(path.stem, named["robot"], int(named["pid"]), str(path)))
    return found


def runtime_folder() -> str:
    """Return the folder of this user's sockets, which nobody else may enter."""
    given = os.environ.get("XDG_RUNTIME_DIR")
    with contextlib.suppress(OSError):
        if given and Path(given).is_absolute() and Path(given).stat().st_uid == os.getuid():
            return str(Path(given) / "yarc")
    return str(Path(tempfile.gettempdir()) / f"yarc-{os.getuid()}")


class Robot:
    """A connection to the process that owns a robot.

    Args:
        which: the path of its socket; or its name, its robot's name or the number of the process; None: the only one that there is. `tcp://HOST:PORT` is the
            port for values of `yarc serve --values`, which takes nothing but values, and needs the token.
        name: what others know this client by; None: no client, but another terminal: it may ask for the status, stop, hold and abort, and resume and
            change the pace where the robot's owner shares that.
        timeout: whoever takes longer to answer hangs [s]; motions may take as long as they like.
        token: of the port for values.

    Attributes:
        welcome: what was told at first; empty without a name.

    Raises:
        Gone: nobody is there.
        Refused: another version of the protocol is spoken there.
    """

    def __init__(
        self,
        which: str | int | None = None,
        name: str | None = "client",
        timeout: float = REPLY_TIME,
        token: str | None = None,
    ) -> None:
        self.path = _path_of(which)
        self.welcome: Message = {}
        self._timeout = timeout
        self._numbers = 0
        self._events: collections.deque[Message] = collections.deque()
        self._answers: dict[int, Message] = {}
        self._writing = threading.Lock()
        self._buffer = b""
        self._listens = False
        there = _TCP.fullmatch(self.path)
        self._wire = socket.socket(_family(there))
        try:
            self._wire.settimeout(timeout)
            self._wire.connect(self.path if there is None else (there["host"], int(there["port"])))
        except _LATE:
            self._wire.close()
            raise TimeoutError(f"{self.path} doesn't answer within {timeout:g} s") from None
        except OSError as error:
            self._wire.close()
            raise Gone(f"{self.path} can't be reached: {(error.strerror or str(error)).lower()}") from None
        try:
            if token is not None:
                self._send({"token": token})
                self._take(timeout)
            if name is not None:
                self.welcome = self.ask("hello", version=VERSION, name=name)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Robot:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Go away, from any thread: one that waits for an answer or an event gets `Gone`. If this client owned the robot, it comes to rest on its path."""
        with contextlib.suppress(OSError):
            self._wire.shutdown(socket.SHUT_RDWR)
        self._wire.close()

    # what there is to say

    def ask(self, order: str, *, patience: float | None = None, **fields: Any) -> Message:
        """Order or ask something, and return the answer.

        Args:
            order: the word for it.
            patience: how long the answer may take [s]; None: as for the connection.
            fields: what belongs to it.

        Raises:
            Refused: it was denied.
            TimeoutError: there is no answer in time; it may still come, and is forgotten.
            Gone: nobody is there any more.
        """
        return self._asked(dict(fields, order=order), self._timeout if patience is None else patience)

    def order(self, order: str, **fields: Any) -> int:
        """Order something without waiting, from any thread: what is ordered by one connection is heard in this order. Return a number for `answer`.

        Raises:
            Gone: nobody is there any more.
        """
        return self._ordered(dict(fields, order=order))

    def answer(self, number: int, patience: float | None = None) -> Message:
        """Wait for the answer to an `order`, and return it; arguments and errors as for `ask`."""
        return self._answered(number, self._timeout if patience is None else patience)

    def want(self, **fields: Any) -> Message:
        """Say what is wanted of a live motion (`joints`, `pose`, `velocity`, `twist` or `finish`), and return the answer; see `ask`."""
        return self._asked(dict(fields), self._timeout)

    def status(self) -> Message:
        """Return how it is going."""
        return self.ask("status")

    def own(self, shared: bool = False) -> None:
        """Own the robot; `shared`: others may resume and change the pace as well."""
        self.ask("own", shared=shared)

    def release(self) -> Message:
        """Leave the robot to nobody; the answer tells of the log."""
        return self.ask("release")

    def offer(self, text: str) -> Message:
        """Have a line, a block or several lines planned and proved from where the robot stands; nothing moves.

        Returns:
            `offer`, or None in its place, and `findings`.
        """
        return self.ask("offer", patience=float("inf"), text=text)

    def go(self, offer: int) -> Message:
        """Carry an offer out, by its number, and return how it has ended."""
        return self.ask("go", patience=float("inf"), offer=offer)

    def load(self, file: str, **fields: Any) -> Message:
        """Have a program compiled and proved to be run: `program`, or None in its place, and `findings`."""
        return self.ask("load", patience=float("inf"), file=str(Path(file).absolute()), **fields)

    def run(self, program: int, approach: bool = False, times: int | None = 1) -> Message:
        """Carry a program out that was loaded, by its number, and return how it has ended."""
        return self.ask("run", patience=float("inf"), program=program, approach=approach, times=times)

    def fill(self, values: dict[str, int], number: int | None = None) -> Message:
        """Give registers that the program takes from OUTSIDE their values, while it waits for them; all are taken, or none.

        Args:
            values: by the names of registers.
            number: of the question that is answered, as `wanted` has told it; None: whichever is open.

        Raises:
            Refused: they came early, late or again, or aren't what the registers hold.
        """
        return self.ask("fill", values=values, number=number)

    def wanted(self, patience: float | None = None) -> Message:
        """Wait until the program takes values, and return which: `number`, `place`, `registers` with their ranges, and which are `needed`.

        Args:
            patience: how long [s]; None: for ever. Other events that come meanwhile are dropped.

        Raises:
            TimeoutError: it takes none in time.
            Gone: nobody is there any more.
        """
        until = None if patience is None else time.monotonic() + patience
        if not self._listens:
            self.ask("listen", positions=False)
            self._listens = True
        now = self.status().get("wants")
        self._events = collections.deque(one for one in self._events if one.get("event") != "values_wanted")
        while not now:
            while not self._events:
                self._take(None if until is None else max(until - time.monotonic(), 0.001))
            event = self._events.popleft()
            now = event.get("wanted") if event.get("event") == "values_wanted" else None
        answer: Message = now
        return answer

    def stop(self) -> None:
        """Have the robot come to rest on its path, and end what is under way; from any thread, without waiting for an answer."""
        self._send({"order": "stop"})

    def hold(self) -> None:
        """Have the robot come to rest on its path, ready to go on; else as `stop`."""
        self._send({"order": "hold"})

    def abort(self) -> None:
        """Have each motor come to rest at once, off the path; else as `stop`."""
        self._send({"order": "abort"})

    def events(self, positions: bool = False) -> Iterator[Message]:
        """Yield all events from now on, until nobody tells any.

        Args:
            positions: whether positions are wanted, 50 times a second.
        """
        self.ask("listen", positions=positions)
        while True:
            while self._events:
                yield self._events.popleft()
            try:
                self._take(None)
            except Gone:
                return

    # lines

    def _asked(self, content: Message, patience: float) -> Message:
        return self._answered(self._ordered(content), patience)

    def _ordered(self, content: Message) -> int:
        with self._writing:
            self._numbers += 1
            number = self._numbers
        self._send(dict(content, id=number))
        return number

    def _answered(self, number: int, patience: float) -> Message:
        while number not in self._answers:
            self._take(None if patience == float("inf") else patience)
        answer = self._answers.pop(number)
        if answer.get("ok") is not True:
            raise Refused(
                str(answer.get("error")), str(answer.get("help") or ""), str(answer.get("code") or "")
            )
        return answer

    def _send(self, content: Message) -> None:
        try:
            with self._writing:
                self._wire.sendall(json.dumps(content).encode() + b"\n")
        except OSError as error:
            raise self._gone() from error

    def _take(self, patience: float | None) -> None:
        """Read one line, and keep what it says."""
        content = self._read(patience)
        if "event" in content:
            self._events.append(content)
            return
        number = content.get("id")
        if isinstance(number, int):
            self._answers[number] = content
        elif content.get("ok") is False:
            raise Refused(str(content.get("error")))
        elif content.get("ok") is not True:
            raise Refused(_NOT_UNDERSTOOD)

    def _read(self, patience: float | None) -> Message:
        try:
            self._wire.settimeout(patience)
            while b"\n" not in self._buffer:
                data = self._wire.recv(1 << 16)
                if not data or len(self._buffer) > _LONGEST:
                    raise self._gone()
                self._buffer += data
        except _LATE:
            raise TimeoutError(f"{self._called} doesn't answer within {patience:g} s") from None
        except OSError as error:
            raise self._gone() from error
        line, _, self._buffer = self._buffer.partition(b"\n")
        try:
            content = json.loads(line)
        except ValueError:
            content = None
        if not isinstance(content, dict):
            raise Refused(_NOT_UNDERSTOOD)
        return content

    @property
    def _called(self) -> str:
        return self.path if _TCP.fullmatch(self.path) else Path(self.path).stem

    def _gone(self) -> Gone:
        return Gone(f"{self._called} has ended")


def _family(there: re.Match[str] | None) -> socket.AddressFamily:
    if there is None:
        return socket.AF_UNIX
    return socket.AF_INET6 if ":" in there["host"] else socket.AF_INET


def _path_of(which: str | int | None) -> str:
    if isinstance(which, str) and (_TCP.fullmatch(which) or os.sep in which or which.endswith(".sock")):
        return which
    there = find()
    fitting = [
        one for one in there if which is None or str(which).lower() in (one.name, one.robot, str(one.pid))
    ]
    if len(fitting) == 1:
        return fitting[0].path
    names = ", ".join(one.name for one in there) or "none"
    wanted = "a robot" if which is None else repr(which)
    raise Gone(f"there is no one process that owns {wanted}: there is {names}")


def _answers(path: str) -> bool:
    """Whether a process of this user listens on a socket."""
    try:
        found = os.lstat(path)
    except OSError:
        return False
    if not stat.S_ISSOCK(found.st_mode) or found.st_uid != os.getuid():
        return False
    with socket.socket(socket.AF_UNIX) as wire:
        wire.settimeout(0.5)
        try:
            wire.connect(path)
        except _LATE:  # it hangs, and is alive
            return True
        except OSError:
            return False
    return True
