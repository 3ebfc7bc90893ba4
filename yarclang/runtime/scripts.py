"""What a kind of controller brings to a run: how bytes are exchanged with it, and the scripts that look at it, move it and bring it to rest."""

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
    """One connection, seen from here, without a socket and without a clock: a request becomes bytes, and bytes that came become events.

    One request is in flight at a time. Times are in s, on any clock that only goes forward.
    """

    @property
    def lost(self) -> bool:
        """True if nothing more can be asked on this connection."""

    @property
    def deadline(self) -> float | None:
        """When `check` is due [s]; None while nothing is in flight."""

    def send(self, request: Any, now: float, timeout: float) -> bytes:
        """Begin a request that may wait for `timeout` [s] for each part of its answer; return all bytes to send now."""

    def outgoing(self) -> bytes:
        """Return bytes to send now, each once."""

    def receive(self, data: bytes, now: float) -> tuple[Any, ...]:
        """Take bytes that came, in any chopping."""

    def check(self, now: float) -> tuple[Any, ...]:
        """Return what a deadline says that is over."""

    def close(self) -> tuple[Any, ...]:
        """Take note that the other end has closed the connection."""


@dataclass(frozen=True, slots=True)
class Measured:
    """How fast the link is, in sentences, and by numbers with their units in their names."""

    lines: tuple[str, ...]
    values: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class JointPlace:
    """Where a joint is, in `unit`: `commanded`, and `actual` as the controller reckons; None where it can't be asked."""

    name: str
    unit: str
    commanded: float
    actual: float | None


@dataclass(frozen=True, slots=True)
class Picture:
    """What a controller says of itself: of what kind it is, what of a program, its pace [%], the guard as a value and in words, each motor in words."""

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
    """What a home search of a motor would do.

    Attributes:
        motor: its number.
        joint: the name of the joint that it moves.
        unit: of that joint, deg or mm.
        speed: how fast the controller searches, with its sign [unit/s].
        longest: how long it may take [s].
        refused: why it isn't done here; empty: it may be.
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
    """How many lines of the settings were taken, of how many; what ended it before, empty if nothing did, and what to do."""

    sent: int
    of: int
    what: str = ""
    remedy: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Services:
    """Scripts that get a controller ready, at rest.

    Attributes:
        enable: closes the loops of the motors that are open; what isn't as it must be.
        disable: opens all loops; likewise.
        searches: what home searches would do.
        home: lets a motor search its home.
        end_search: ends a search that nobody watches.
        check_open: raises `Trouble` where settings may not be sent.
        send: sends settings, line by line.
        save: lets the controller keep them.
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
    """Ends what a controller does without a job of ours."""

    def __call__(self, operation: Any, robot: Robot, /, *, abort: bool) -> Script[Array | None]:
        """Hold it (or abort it), and end it at rest; return where the robot stands then (n,) [rad or m], None if nobody knows."""


def _reads_nothing(operation: Any, variables: Sequence[str]) -> Script[tuple[float, ...]]:  # noqa: ARG001
    yield from ()
    raise Trouble("this kind of controller has no variables", "leave them out")


def _writes_nothing(operation: Any, variable: str, value: float) -> Script[None]:  # noqa: ARG001
    yield from ()
    raise Trouble("this kind of controller has no variables", "leave them out")


def _measures_nothing(operation: Any, robot: Robot) -> Script[Measured]:  # noqa: ARG001
    yield from ()
    return Measured((), {})


@dataclass(frozen=True, slots=True, eq=False)
class Scripts:
    """All that a run asks of a kind of controller. The first argument of each script is what `operation` has made.

    Attributes:
        operation: makes what the scripts of a session share.
        exchange: makes a connection's end.
        last_words: bytes that hold (or abort) all motion on a connection whose answers can't be trusted any more.
        connect: makes a connection, and the form of its answers sure.
        look: looks at everything that must be so before a motion; nothing moves.
        idle: tells where the robot is, until something is wanted.
        stands_at: where the joints are commanded to be (n,) [rad or m].
        perform: carries a job out, to its end or to rest.
        perform_live: likewise a live motion; None: the kind has none.
        end_leftovers: ends a program that was left in the middle, where the robot stands; whether there was one.
        end_what_runs: see there.
        picture: what a controller says of itself; whatever it does isn't disturbed.
        patience: how long a controller may be busy before that is a fault [s].
        read: the values of variables; without it, the kind has none.
        write: gives a variable a value, at rest; without it, the kind has none.
        measured: how fast the link is; without it, nobody measures it.
        services: what gets a controller ready; None: the kind has none.
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
        KeyError: there is no such kind.
    """
    found: Scripts = import_module(module_of(kind)).BACKEND.scripts()
    return found
