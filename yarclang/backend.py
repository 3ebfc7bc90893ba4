"""Describes a kind of controller to the rest by one value, `BACKEND`, in `backend.py` of its package `backend_*`.

Neutral rooms ask it, and never which kind it is. Its `kind` is enough to read a robot; all else is imported when it is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol

from yarclang.diagnostics import Diagnostic, Result
from yarclang.emitted.purposes import Listed, Stretch, moves_alone
from yarclang.frozen import frozen
from yarclang.memory import Memory
from yarclang.motion.limits import Grid
from yarclang.motion.plan import MotionPlan
from yarclang.robot.controller import Kind
from yarclang.robot.kinds import kind_names, module_of
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.source import SourceFile

if TYPE_CHECKING:
    from yarclang.certify.claims import Claims
    from yarclang.certify.read.reader import Reader
    from yarclang.certify.read.text import ControllerText
    from yarclang.hir import Program
    from yarclang.runtime.inspection import Item
    from yarclang.runtime.live import Live, Source
    from yarclang.runtime.scripts import Scripts
    from yarclang.runtime.session import Leash
    from yarclang.simulated_cell.playing import SimulatedCell


@frozen(eq=False)
class Written:
    """A program's text but for its header, and what the header says of it.

    Attributes:
        target: what the text is for.
        loading: what a person who loads the text by hand must know.
        start: where it starts: each axis's name and a decimal number in its axis unit, nothing between, as `A0.5B-3`.
        segments: the segment times in use as printed [ms], up to four digits and twelve decimals: none, one, or the least and the largest.
        time: prints a segment time [ms].
        text: returns the whole text with the lines of a header.
    """

    target: str
    loading: str
    start: str
    segments: tuple[str, ...]
    time: Callable[[float], str]
    text: Callable[[tuple[str, ...]], str]


@frozen(eq=False)
class Sendable:
    """The lines of a text that are streamed.

    Attributes:
        lines: each with its number in the text.
        guarded: the lines after which the controller holds by itself when it hears no more of this computer.
        capacity: how many lines surely fit into the controller's buffer.
        own: what else the scripts of the kind need.
    """

    lines: tuple[tuple[int, str], ...]
    guarded: tuple[int, ...]
    capacity: int
    own: Any = None


@frozen(eq=False)
class Settings:
    """What a controller is told once about a robot.

    Attributes:
        text: writes it.
        judge: proves it, or what somebody has made of it; what was proved as sentences, None with the errors.
        differences: what a text that was proved says otherwise than the one that is written.
        items: what is looked at on the controller before anything moves.
        lines: what of the text is sent.
    """

    text: Callable[[Robot], str]
    judge: Callable[[SourceFile, Robot], Result[tuple[str, ...]]]
    differences: Callable[[SourceFile, Robot], tuple[Diagnostic, ...]]
    items: Callable[[Robot], tuple[Item, ...]]
    lines: Callable[[str], tuple[str, ...]]


NO_SETTINGS = Settings(
    text=lambda robot: "",  # noqa: ARG005
    judge=lambda source, robot: Result(()),  # noqa: ARG005
    differences=lambda source, robot: (),  # noqa: ARG005
    items=lambda robot: (),  # noqa: ARG005
    lines=lambda text: (),  # noqa: ARG005
)
"""Those of a controller that has to be told nothing."""


@frozen(eq=False)
class LiveWriting:
    """How live motions are written.

    Attributes:
        decimals: how many decimals a robot's positions are printed with, in segments of so many seconds.
        lines: prints positions (k, n) [rad or m] with so many decimals.
        points: reads them back (k, n) [rad or m], by the judge's own reading; else what is wrong with them.
        motion: makes a live motion: of a robot that stands somewhere (n,), and may stand so far off that (n,) [rad or m], with segments [s] and decimals, called
            so, whose lines are made by a source.
    """

    decimals: Callable[[Robot, float], int]
    lines: Callable[[Robot, Array, int], tuple[str, ...]]
    points: Callable[[Robot, tuple[str, ...]], Array | str]
    motion: Callable[[Robot, Array, Array, float, int, str, Source], Live]


@frozen(eq=False)
class Simulated:
    """A controller that is simulated in this process: the port of this computer at which it listens, and its time, if it waits for its session."""

    port: int
    leash: Leash | None


class Server(Protocol):
    """A simulated controller on a port of this computer."""

    host: str
    port: int
    rate: float | None

    async def start(self) -> None:
        """Listen."""

    async def serve(self) -> None:
        """Be there until somebody cancels this."""

    async def close(self) -> None:
        """End all connections."""

    def tell(self, text: str) -> None:
        """Say something at the controller's time."""

    def differences(self) -> tuple[str, ...]:
        """Return what programs have used that is simulated otherwise, in words."""


class ServerMaker(Protocol):
    """Makes a simulated controller for `yarc sim`."""

    def __call__(
        self,
        robot: Robot | None,
        cell: SimulatedCell | None,
        /,
        *,
        host: str,
        port: int,
        rate: float | None,
        faults: tuple[Any, ...],
        seed: int,
        tell: Callable[[float, str], None],
    ) -> Server:
        """Make one that is commissioned for a robot (None: a bare one), among the machines of a cell."""


@frozen(eq=False)
class Bench:
    """The simulator of `yarc sim`: what a bare controller is called, how a text becomes a fault (`ValueError` says what is wrong with it), and who makes one."""

    title: str
    fault: Callable[[str], Any]
    server: ServerMaker


@frozen(eq=False)
class Backend:
    """A kind of controller.

    Attributes:
        kind: what a robot.toml tells of it.
        suffix: how files with its texts end.
        targets: what texts can be for; the first is for being streamed.
        port: where it listens on the network, if an address says nothing else.
        grid: the segment times for a robot, none longer than so many ms, where that is given; None, with a finding, where it can't be.
        write: writes a plan for a target, within a tolerance; None, with findings, where the controller can't do it.
        reader: returns the judge's reader of its texts.
        sendable: what of a text that was judged is streamed; a finding, if nothing is.
        scripts: returns how it is talked to.
        simulated: a simulator with a robot that stands somewhere (n,) [rad or m], whose time passes so many times as fast, among the machines of a cell.
        settings: returns what it is told once about a robot.
        live: returns how live motions are written; None: it has none.
        bench: returns the simulator of `yarc sim`; without it, there is none.
        proof: returns the proof of a text that was certified, for a checker that knows no other room; a finding, if there is none. It is given the text, what the judge has
            read, the program, the robot, the tolerance and the planner's claims. Without it, no text has a proof.
        purposes: tells what each line of a text is for; without it, the moves that the header lists are known, and no other line.
    """

    kind: Kind
    suffix: str
    targets: tuple[str, ...]
    port: int
    grid: Callable[[Robot, float | None], Result[Grid]]
    write: Callable[[MotionPlan, str, Tolerance, Memory], Result[Written]]
    reader: Callable[[], Reader]
    sendable: Callable[[ControllerText, Robot], Sendable | Diagnostic]
    scripts: Callable[[], Scripts]
    simulated: Callable[[Robot, Array, float, SimulatedCell | None], AbstractContextManager[Simulated]]
    settings: Callable[[], Settings] = lambda: NO_SETTINGS
    live: Callable[[], LiveWriting | None] = lambda: None
    bench: Callable[[], Bench] | None = None
    proof: Callable[[str, ControllerText, Program, Robot, Tolerance, Claims], str | Diagnostic] | None = None
    purposes: Callable[[Sequence[str], int, Sequence[Listed], Mapping[int, int]], Iterator[Stretch]] = (
        moves_alone
    )


def backend_of(robot: Robot) -> Backend:
    """Return the backend of a robot's controller."""
    return backend_called(robot.controller.kind)


def backend_called(kind: str) -> Backend:
    """Return the backend of a kind of controller.

    Raises:
        KeyError: there is no such kind.
    """
    found: Backend = import_module(module_of(kind)).BACKEND
    return found


def backend_for(target: str) -> Backend | None:
    """Return the backend whose texts are for a target; None if no kind has such a target."""
    backends = map(backend_called, kind_names())
    return next((one for one in backends if target in one.targets), None)


def suffixes() -> tuple[str, ...]:
    """Return how files with the texts of all kinds end."""
    return tuple(backend_called(name).suffix for name in kind_names())
