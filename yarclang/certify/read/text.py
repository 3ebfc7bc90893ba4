"""What a controller text says, as the judge reads it: commands of its header, sequences of moves, and what stands between them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.decisions import Register, Searched, Value, Watch
from yarclang.emitted.header import Header
from yarclang.frozen import frozen
from yarclang.lasting import Mark, Part, Schedule, schedule_of
from yarclang.robot.model import Array
from yarclang.units import MS

_MARKS: dict[str, Mark] = {
    "wait": "wait",
    "hold": "hold",
    "when": "when",
    "else": "else",
    "end": "end",
    "stop": "finish",
    "abort": "finish",
    "loop": "loop",
    "next": "next",
    "exit": "exit",
    "endloop": "endloop",
}


@frozen
class Unreadable:
    """The first place of the text that isn't what yarcc emits: its line (from 1), the reason, the code."""

    line: int
    reason: str
    code: str = "Y1151"


@frozen
class Entry:
    """A line `; command` of the header: which move lines belong to which step of the program.

    `first` and `last` are lines of the text, from 1; None for a step without move lines. `blend` is the number of segments, half
    of them before and half behind the command's end, in which it flows into the next one; None where it ends at rest. `any_jerk`
    says that its law has no limit of the jerk.
    """

    at: int
    step: int
    index: str
    name: str
    source_line: int
    first: int | None
    last: int | None
    blend: int | None = None
    any_jerk: bool = False


@frozen
class Sent:
    """Lines that the controller is sent, as they stand in the text from line `first` on: one, or neighbouring move lines joined by line feeds."""

    first: int
    text: str

    def numbered(self) -> Iterator[tuple[int, str]]:
        """Yield each line with its number in the text."""
        yield from enumerate(self.text.split("\n"), self.first)


@frozen
class Put:
    """A variable gets a value: at rest, or, where it is `synchronous`, when the move of the next line begins."""

    line: int
    variable: str
    value: float
    synchronous: bool = False


@frozen(eq=False)
class Run:
    """One spline sequence: the move lines between two values of TM.

    `segment_ms` is TM [ms], exact; `points` (M, n) are the printed numbers [deg or mm];
    `lines` (M,) are their lines in the text. `puts` are the outputs set between them, while the robot moves.
    """

    segment_ms: float
    tm_line: int
    points: Array
    lines: NDArray[np.int64]
    puts: tuple[Put, ...] = ()

    @property
    def segment(self) -> float:
        """TM [s]."""
        return self.segment_ms * MS

    @property
    def duration(self) -> float:
        """The time that it takes [s]. A sequence begins and ends with a segment of its own (TUM 289)."""
        return (len(self.lines) + 2) * self.segment


@frozen
class Dwelt:
    """DWELL: the sequence ends, and the robot stands for `milliseconds` more."""

    line: int
    milliseconds: float


@frozen
class Barred:
    """A barrier: the program goes no further by itself. As the header's map says: what kind, which step, what is waited for
    (`condition`, or -), how long [s] (None: for ever), and the input's name or the operator's text.

    `decided` is the condition of a `when`, or of a `wait` that isn't for one value of one input, and `again` says that it is decided with what was read before; of a `set` it is the number that `register` gets, or `output`, the variable of one or of all bits of a group; of a `hold` the operator's answer goes into `register`.
    """

    line: int
    kind: str
    step: int
    condition: str
    timeout: float | None
    name: str
    decided: Value | None = None
    again: bool = False
    register: str = ""
    output: str = ""


@frozen(eq=False)
class Stood:
    """A slow RAPID to where the robot stands: `point` (n,) [deg or mm]."""

    line: int
    point: Array


@frozen(eq=False)
class Start:
    """Where the motion starts: `printed` (n,) [deg or mm] in line `line`; None where only the kind's reader knows how the text says it (`Reader.start`)."""

    line: int
    printed: Array | None


@frozen(eq=False)
class ControllerText:
    """What the text makes the controller do, and the very lines that are sent to have it done.

    Attributes:
        header: what the text says about itself.
        entries: the map of commands.
        start: where the motion starts.
        course: what is done, in order.
        outputs: variables and the values that they take when the guard has held the motion.
        decimals: the most that a move line prints.
        quantum: the step in which the controller keeps segment times [s].
        registers: integers that the runtime keeps, with their ranges and first values.
        watches: inputs that hold the motion while they have a value.
        searches: motions that an input ends.
        own: what else it says, for the rooms of its kind alone.
    """

    header: Header
    entries: tuple[Entry, ...]
    start: Start
    course: tuple[Run | Dwelt | Put | Barred | Stood, ...]
    outputs: tuple[tuple[str, float], ...]
    decimals: int
    quantum: float
    own: Any = None
    registers: tuple[Register, ...] = ()
    watches: tuple[Watch, ...] = ()
    searches: tuple[Searched, ...] = ()

    @property
    def target(self) -> str:
        """What the text is for, as its header says."""
        return self.header.target

    @property
    def runs(self) -> tuple[Run, ...]:
        """The sequences of moves."""
        return tuple(item for item in self.course if isinstance(item, Run))

    @property
    def schedule(self) -> Schedule:
        """When each item of the course begins, and how long all of it takes."""
        return schedule_of(_part(item) for item in self.course)


Assignment = tuple[int | None, str, float]
"""Line of the text (None: in the PLC of safe values), variable, value."""


def assignments_of(text: ControllerText) -> Iterator[Assignment]:
    """Yield what the text assigns to outputs, in the order of its lines."""
    for variable, value in text.outputs:
        yield None, variable, value
    for item in text.course:
        match item:
            case Put(line=line, variable=variable, value=value):
                yield line, variable, value
            case Run(puts=puts):
                yield from ((put.line, put.variable, put.value) for put in puts)


def _part(item: Run | Dwelt | Put | Barred | Stood) -> Part:
    """Return the time that an item of the course takes [s], or what it waits for."""
    match item:
        case Run():
            return item.duration
        case Dwelt(milliseconds=milliseconds):
            return float(milliseconds) * MS
        case Barred(kind="when", timeout=float()):
            return "ask"
        case Barred(kind=kind):
            return _MARKS.get(kind, 0.0)
        case _:
            return 0.0
