"""Command and watch a robot that yarclang drives. This file may be copied: it needs no other package.

A process that owns a robot (`yarc serve`, `run`, `exec`, `repl`, `follow`) listens on a Unix socket of its
user. Each line sent or received is one JSON object; docs/coordinator.md of yarclang lists all of them.

    from yarclang.client import Robot

    with Robot("industrial6", name="my cell") as robot:
        robot.own()
        offer = robot.offer("MOVEJ 10 0 0 0 20 0 [2] (deg,s)")
        print(offer["offer"]["duration_s"])
        print(robot.go(offer["offer"]["number"])["well"])
        for event in robot.events():
            print(event)

Written for Python 3.8 and later. Each `Robot` is for one thread, except that any thread may call `order`,
`stop`, `hold`, `abort` and `close`.
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
"""Version of the protocol."""

REPLY_TIME = 5.0
"""Longest time for an answer that needs no motion [s]. A busy computer may need seconds."""

_LONGEST = 1 << 26
"""Longest line of an answer that is accepted [bytes]."""

_NOT_UNDERSTOOD = "what comes back isn't understood: is it another version of yarc?"

_NAME = re.compile(r"(?P<robot>.+)-(?P<pid>[0-9]{1,10})\.sock")

_TCP = re.compile(r"tcp://\[?(?P<host>[^\]]+)\]?:(?P<port>[0-9]{1,5})")

_LATE = (socket.timeout, BlockingIOError)
"""Errors that a socket raises if its process doesn't answer, or if too many clients wait for the process."""

Message = Dict[str, Any]


class Refused(Exception):  # noqa: N818  (what a reply says)
    """An order was refused.

    The text is the reason. `help` is the remedy and `code` the code of the finding; both may be empty.
    """

    def __init__(self, error: str, help_: str = "", code: str = "") -> None:
        super().__init__(error)
        self.error = error
        self.help = help_
        self.code = code


class Gone(Exception):  # noqa: N818
    """The process can't be reached, or has ended."""


class Found(NamedTuple):
    """A process that owns a robot.

    Attributes:
        name: name of the process, such as `industrial6-4711`.
        robot: name of the robot.
        pid: number of the process.
        path: path of the socket on which the process listens.
    """

    name: str
    robot: str
    pid: int
    path: str


def find(folder: str | None = None) -> list[Found]:
    """Return the processes of this user that own robots, sorted by name.

    Args:
        folder: folder of the sockets; None for the user's own.
    """
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
        which: the process: the path of its socket, its name, its number, or the name of its robot. None
            stands for the only process that owns a robot. `tcp://HOST:PORT` is the port of `yarc serve
            --values`; this port accepts only values, and needs the token.
        name: name of this client for others. None: the connection isn't a client, but has the rights of
            another terminal: it may ask for the status, stop, hold and abort. If the robot's owner shares
            the robot, it may also resume and change the override.
        timeout: longest time for an answer [s]; motions may take as long as they need.
        token: token for the port of values.

    Attributes:
        welcome: the first message of the process; empty for a connection without a name.

    Raises:
        Gone: the process can't be reached.
        Refused: the process uses another version of the protocol.
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
        """Close the connection, from any thread.

        A thread that waits for an answer or an event gets `Gone`. If this client owned the robot, the robot
        stops on its path.
        """
        with contextlib.suppress(OSError):
            self._wire.shutdown(socket.SHUT_RDWR)
        self._wire.close()

    # Orders.

    def ask(self, order: str, *, patience: float | None = None, **fields: Any) -> Message:
        """Send an order or a question, and return the answer.

        Args:
            order: the word of the order.
            patience: longest time for the answer [s]; None for that of the connection.
            fields: further fields of the order.

        Raises:
            Refused: the order was refused.
            TimeoutError: no answer came in time. An answer that comes later is ignored.
            Gone: the process has ended.
        """
        return self._asked(dict(fields, order=order), self._timeout if patience is None else patience)

    def order(self, order: str, **fields: Any) -> int:
        """Send an order without waiting, from any thread, and return a number for `answer`.

        The orders of a connection are received in the order of their calls.

        Raises:
            Gone: the process isn't there any more.
        """
        return self._ordered(dict(fields, order=order))

    def answer(self, number: int, patience: float | None = None) -> Message:
        """Wait for the answer to an `order`, and return it. Arguments and errors are those of `ask`."""
        return self._answered(number, self._timeout if patience is None else patience)

    def want(self, **fields: Any) -> Message:
        """Send the target of a live motion (`joints`, `pose`, `velocity`, `twist` or `finish`), and return
        the answer. Errors are those of `ask`.
        """
        return self._asked(dict(fields), self._timeout)

    def status(self) -> Message:
        """Return the robot's status."""
        return self.ask("status")

    def own(self, shared: bool = False) -> None:
        """Become the robot's owner. With `shared`, others may resume and change the pace as well."""
        self.ask("own", shared=shared)

    def release(self) -> Message:
        """Give up the robot, so that nobody owns it. The answer names the log."""
        return self.ask("release")

    def offer(self, text: str) -> Message:
        """Plan and prove one or more lines or a block from the robot's current position. Nothing moves.

        Returns:
            `offer`, which may be None, and `findings`.
        """
        return self.ask("offer", patience=float("inf"), text=text)

    def go(self, offer: int) -> Message:
        """Carry out an offer by its number, and return how it ended."""
        return self.ask("go", patience=float("inf"), offer=offer)

    def load(self, file: str, **fields: Any) -> Message:
        """Compile and prove a program. The answer has `program`, which may be None, and `findings`."""
        return self.ask("load", patience=float("inf"), file=str(Path(file).absolute()), **fields)

    def run(self, program: int, approach: bool = False, times: int | None = 1) -> Message:
        """Run a loaded program by its number, and return how it ended."""
        return self.ask("run", patience=float("inf"), program=program, approach=approach, times=times)

    def fill(self, values: dict[str, int], number: int | None = None) -> Message:
        """Give values to registers that are declared with OUTSIDE, while the program waits for these values.

        If one value is refused, all are refused.

        Args:
            values: values by the names of registers.
            number: number of the question that these values answer, as returned by `wanted`; None for any
                open question.

        Raises:
            Refused: the values came early, late or twice, or don't fit the registers.
        """
        return self.ask("fill", values=values, number=number)

    def wanted(self, patience: float | None = None) -> Message:
        """Wait until the program asks for values, and return its question.

        The question has `number`, `place`, `registers` with their ranges, and `needed`: the names of the
        registers that must get a value.

        Args:
            patience: longest time [s]; None waits without limit. Other events are dropped in the meantime.

        Raises:
            TimeoutError: the program doesn't ask for values in time.
            Gone: the process has ended.
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
        """Stop the robot on its path and end the running motion, from any thread, without waiting for an
        answer.
        """
        self._send({"order": "stop"})

    def hold(self) -> None:
        """Stop the robot on its path, ready to continue; otherwise like `stop`."""
        self._send({"order": "hold"})

    def abort(self) -> None:
        """Stop each motor at once, off the path; otherwise like `stop`."""
        self._send({"order": "abort"})

    def events(self, positions: bool = False) -> Iterator[Message]:
        """Yield all events from now on, until the process ends.

        Args:
            positions: True for positions as well, 50 times a second.
        """
        self.ask("listen", positions=positions)
        while True:
            while self._events:
                yield self._events.popleft()
            try:
                self._take(None)
            except Gone:
                return

    # Lines.

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
        """Read one line, and store its message."""
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
    """Return True if a process of this user listens on a socket."""
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
        except _LATE:  # the process hangs, but it exists
            return True
        except OSError:
            return False
    return True
