"""The interface to the kinds of robot controllers. Each kind is described by one value `BACKEND` in
`backend.py` of its package `backend_*`.

Packages that don't depend on a controller use this value without knowing the kind. `kind` is enough to read a
robot's description; everything else is imported when it is needed.
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
    """A controller text without its header, and the values in the header that describe it.

    Attributes:
        target: target of the text, such as a streamed buffer.
        loading: instructions for a person who loads the text by hand.
        start: start position: each axis's name and a decimal number in its axis unit, joined as in `A0.5B-3`.
        segments: segment times [ms] as the text prints them, with up to four digits before the point and
            twelve after it. Only the smallest and the largest are listed; empty if there are no segments.
        time: function that prints a segment time [ms].
        text: function that takes the lines of a header and returns the whole text.
    """

    target: str
    loading: str
    start: str
    segments: tuple[str, ...]
    time: Callable[[float], str]
    text: Callable[[tuple[str, ...]], str]


@frozen(eq=False)
class Sendable:
    """The lines of a controller text that are streamed to the controller.

    Attributes:
        lines: each line with its number in the text.
        guarded: numbers of the lines after which the controller stops the robot by itself if this computer
            falls silent.
        capacity: number of lines that are sure to fit into the controller's buffer.
        own: further data for the communication with this kind of controller.
    """

    lines: tuple[tuple[int, str], ...]
    guarded: tuple[int, ...]
    capacity: int
    own: Any = None


@frozen(eq=False)
class Settings:
    """The settings of a controller for a robot, such as motor limits. All attributes are functions.

    Attributes:
        text: writes the settings.
        judge: proves a settings text, even if a user has edited it. Returns the proved facts as sentences;
            None with errors.
        differences: returns the differences of a proved text from the text that `text` writes.
        items: returns the values that are read from the controller before anything moves.
        lines: returns the lines of the text that are sent.
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
"""The settings of a controller that needs no settings."""


@frozen(eq=False)
class LiveWriting:
    """The functions that write live motions (motions whose target changes while they run).

    Attributes:
        decimals: returns the number of decimals of a robot's positions, for a segment time [s].
        lines: prints positions (k, n) [rad or m] with a number of decimals.
        points: reads printed positions (k, n) [rad or m] with the judge's reader; returns an error text if
            they are wrong.
        motion: creates a live motion from the robot, its position (n,) and tolerances (n,) [rad or m], the
            segment time [s], the decimals, a name, and the source of the lines.
    """

    decimals: Callable[[Robot, float], int]
    lines: Callable[[Robot, Array, int], tuple[str, ...]]
    points: Callable[[Robot, tuple[str, ...]], Array | str]
    motion: Callable[[Robot, Array, Array, float, int, str, Source], Live]


@frozen(eq=False)
class Simulated:
    """A controller that is simulated in this process.

    Attributes:
        port: network port of the controller on this computer.
        leash: clock of the simulation, if the simulation waits for its client; otherwise None.
    """

    port: int
    leash: Leash | None


class Server(Protocol):
    """A simulated controller on a port of this computer."""

    host: str
    port: int
    rate: float | None

    async def start(self) -> None:
        """Start listening."""

    async def serve(self) -> None:
        """Serve until cancelled."""

    async def close(self) -> None:
        """Close all connections."""

    def tell(self, text: str) -> None:
        """Pass a text and the controller's time to the `tell` function of `ServerMaker`."""

    def differences(self) -> tuple[str, ...]:
        """Return descriptions of controller features that programs have used, and that the simulation treats
        differently from a real controller.
        """


class ServerMaker(Protocol):
    """Function that creates a simulated controller for `yarc sim`."""

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
        """Return a simulated controller.

        Args:
            robot: robot for which the controller is set up; None for a controller without a robot.
            cell: cell whose machines are simulated as well; None without a cell.
            host: host to listen on.
            port: port to listen on.
            rate: factor of simulated time relative to real time; None for as fast as possible.
            faults: faults to simulate.
            seed: seed of the random numbers.
            tell: called with the simulated time [s] and a report.
        """


@frozen(eq=False)
class Bench:
    """The simulator that `yarc sim` starts.

    Attributes:
        title: name of a simulated controller without a robot.
        fault: function that converts a text to a fault. Raises ValueError with the reason if the text is
            wrong.
        server: function that creates a simulated controller.
    """

    title: str
    fault: Callable[[str], Any]
    server: ServerMaker


@frozen(eq=False)
class Backend:
    """A kind of controller. Most attributes are functions.

    Attributes:
        kind: keys and properties of this kind in a robot.toml.
        suffix: suffix of files with controller texts.
        targets: targets of controller texts; the first one is for streaming.
        port: default port on the network.
        grid: returns the segment times for a robot, up to a longest one [ms] if it is given. None, with a
            finding, if the controller can't use the longest one.
        write: writes a plan for a target within a tolerance; None, with findings, if the controller can't run
            it.
        reader: returns the judge's reader of controller texts (the judge proves a text independently of the
            planner).
        sendable: returns the lines of a judged text that are streamed; a finding if there are none.
        scripts: returns the scripts of the communication with the controller.
        simulated: returns a simulator with a robot at a position (n,) [rad or m], a time factor, and the
            machines of a cell.
        settings: returns the controller's settings for a robot.
        live: returns the functions that write live motions; None if there are none.
        bench: returns the simulator of `yarc sim`; None if there is none.
        proof: returns the proof of a certified text for the independent checker; a finding if this text has
            none. Its arguments are the text, the judge's reading of it, the program, the robot, the tolerance
            and the planner's claims. The attribute is None for a kind of controller without proofs.
        purposes: yields the purpose of each line of a text. By default, only the purposes of moves are known,
            from the header.
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
    """Return the `Backend` of a robot's kind of controller."""
    return backend_called(robot.controller.kind)


def backend_called(kind: str) -> Backend:
    """Return the backend of a kind of controller.

    Raises:
        KeyError: there is no such kind.
    """
    found: Backend = import_module(module_of(kind)).BACKEND
    return found


def backend_for(target: str) -> Backend | None:
    """Return the `Backend` whose controller texts are for a target; None if there is none."""
    backends = map(backend_called, kind_names())
    return next((one for one in backends if target in one.targets), None)


def suffixes() -> tuple[str, ...]:
    """Return the suffixes of files with controller texts, for all kinds of controllers."""
    return tuple(backend_called(name).suffix for name in kind_names())
