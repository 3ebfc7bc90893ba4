"""The interface of a kind of controller: how bytes are exchanged with the controller, and the scripts that
inspect it, move its robot and bring the robot to rest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Protocol

from yarclang.robot.kinds import DEFAULT, module_of
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Script, Trouble
from yarclang.runtime.inspection import Inspection, Item
from yarclang.runtime.job import Job
from yarclang.runtime.live import Live
from yarclang.runtime.operation import Operation
from yarclang.runtime.outcome import Ended


class Exchange(Protocol):
    """One connection to a controller, without a socket and without a clock: requests become bytes, and
    received bytes become events.

    One request waits for its reply at a time. Times are in s, on any clock that only goes forward.
    """

    @property
    def lost(self) -> bool:
        """Return True if nothing more can be asked on this connection."""

    @property
    def deadline(self) -> float | None:
        """Return the time at which `check` is due [s]; None if no request waits for its reply."""

    def send(self, request: Any, now: float, timeout: float) -> bytes:
        """Begin a request.

        Args:
            request: the request.
            now: the time [s].
            timeout: longest time to wait for each part of the reply [s].

        Returns:
            All bytes to send now.
        """

    def outgoing(self) -> bytes:
        """Return the bytes to send now. Each byte is returned once."""

    def receive(self, data: bytes, now: float) -> tuple[Any, ...]:
        """Process received bytes, however they are split, and return the events in them."""

    def check(self, now: float) -> tuple[Any, ...]:
        """Return the events that follow if the deadline has passed at the time `now` [s]."""

    def close(self) -> tuple[Any, ...]:
        """Record that the other end has closed the connection."""


@dataclass(frozen=True, slots=True)
class Measured:
    """The measured speed of the connection, in sentences, and as numbers with units in their names."""

    lines: tuple[str, ...]
    values: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class JointPlace:
    """The position of a joint, in `unit`: `commanded`, and `actual` as computed by the controller (None if
    the controller refuses this question).
    """

    name: str
    unit: str
    commanded: float
    actual: float | None


@dataclass(frozen=True, slots=True)
class Picture:
    """The state of a controller, as shown to people.

    Attributes:
        kind: kind of the controller.
        firmware: its firmware.
        program: state of its program, in words.
        override: override [%].
        guard: state of the guard, as a value.
        guard_text: state of the guard, in words.
        motors: state of each motor in words, by the motor's number.
        joints: positions of the joints.
    """

    kind: str
    firmware: str
    program: str
    override: float
    guard: float
    guard_text: str
    motors: dict[int, str]
    joints: tuple[JointPlace, ...]


@dataclass(frozen=True, slots=True)
class HomeSearch:
    """The expected effect of a motor's home search.

    Attributes:
        motor: number of the motor.
        joint: name of the joint that the motor moves.
        unit: unit of that joint, deg or mm.
        speed: speed of the search, with its sign [unit/s].
        longest: longest duration of the search [s].
        refused: the reason why the search is not done here; empty if it may be done.
        closed: True if the motor's loop is closed.
    """

    motor: int
    joint: str
    unit: str
    speed: float
    longest: float
    refused: str
    closed: bool


@dataclass(frozen=True, slots=True)
class Sent:
    """Result of sending settings to a controller.

    Attributes:
        sent: number of lines that were sent.
        of: number of all lines.
        what: reason why sending ended early; empty if all lines were sent.
        remedy: what to do if sending ended early.
    """

    sent: int
    of: int
    what: str = ""
    remedy: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Services:
    """Scripts that prepare a controller while its robot is at rest.

    Attributes:
        enable: closes the open loops of motors; returns the remaining problem in words.
        disable: opens all loops; returns the remaining problem in words.
        searches: returns the expected effects of home searches.
        home: lets a motor search its home.
        end_search: ends a home search that no script supervises any more.
        check_open: raises `Trouble` if settings may not be sent.
        send: sends settings, line by line.
        save: stores the settings in the controller.
    """

    enable: Callable[[Any, Robot], Script[str]]
    disable: Callable[[Any, Robot], Script[str]]
    searches: Callable[[Any, Robot], Script[tuple[HomeSearch, ...]]]
    home: Callable[[Any, Robot, int], Script[None]]
    end_search: Callable[[Any], Script[None]]
    check_open: Callable[[Any, Robot], Script[None]]
    send: Callable[[Any, Sequence[str]], Script[Sent]]
    save: Callable[[Any, Robot], Script[None]]


class EndWhatRuns(Protocol):
    """Script that ends everything that a controller does. It needs no job of this process."""

    def __call__(self, operation: Any, robot: Robot, /, *, abort: bool) -> Script[Array | None]:
        """Hold or abort the motion, and end the program at rest, whoever has started them.

        Returns:
            The robot's joint positions (n,) [rad or m]; None if they aren't known.
        """


def _reads_nothing(operation: Any, variables: Sequence[str]) -> Script[tuple[float, ...]]:  # noqa: ARG001
    yield from ()
    raise Trouble("this kind of controller has no accessible variables", "leave them out")


def _writes_nothing(operation: Any, variable: str, value: float) -> Script[None]:  # noqa: ARG001
    yield from ()
    raise Trouble("this kind of controller has no accessible variables", "leave them out")


def _measures_nothing(operation: Any, robot: Robot) -> Script[Measured]:  # noqa: ARG001
    yield from ()
    return Measured((), {})


@dataclass(frozen=True, slots=True, eq=False)
class Scripts:
    """All scripts of a kind of controller. The first argument of each script is the result of `operation`.

    Attributes:
        operation: creates the state that the scripts of a session share.
        exchange: creates the connection object.
        last_words: returns the bytes that hold (or abort) all motion on a connection whose answers can't be
            trusted any more.
        connect: makes a connection, and sets the format of its answers.
        look: checks everything that must be true before a motion; nothing moves.
        idle: reports the robot's position until the session has something else to do.
        stands_at: returns the commanded joint positions (n,) [rad or m].
        perform: performs a job, to its end or to rest.
        perform_live: performs a live motion; None: the kind has no such script.
        end_leftovers: ends a program that was left unfinished on the controller, where the robot stands;
            returns True if there was one.
        end_what_runs: see `EndWhatRuns`.
        picture: returns the controller's state without disturbing its work.
        patience: longest time that a controller may be busy without a fault [s].
        read: returns the values of variables; None: the kind has no such script.
        write: sets a variable, at rest; None: the kind has no such script.
        measured: measures the connection; None: the kind has no such script.
        services: scripts that prepare a controller; None: the kind has none.
    """

    operation: Callable[[], Operation]
    exchange: Callable[[], Exchange]
    last_words: Callable[[bool], bytes]
    connect: Callable[[Any], Script[None]]
    look: Callable[[Any, Robot, Sequence[Item]], Script[Inspection]]
    idle: Callable[[Any, Robot, Callable[[], bool]], Script[None]]
    stands_at: Callable[[Any, Robot], Script[Array]]
    perform: Callable[[Any, Job], Script[Ended]]
    perform_live: Callable[[Any, Live], Script[Ended]] | None
    end_leftovers: Callable[[Any, Robot], Script[bool]]
    end_what_runs: EndWhatRuns
    picture: Callable[[Any, Robot], Script[Picture]]
    patience: float
    read: Callable[[Any, Sequence[str]], Script[tuple[float, ...]]] = _reads_nothing
    write: Callable[[Any, str, float], Script[None]] = _writes_nothing
    measured: Callable[[Any, Robot], Script[Measured]] = _measures_nothing
    services: Services | None = None


def scripts_of(kind: str = DEFAULT) -> Scripts:
    """Return the scripts of a kind of controller.

    Raises:
        KeyError: there is no kind of this name.
    """
    found: Scripts = import_module(module_of(kind)).BACKEND.scripts()
    return found
