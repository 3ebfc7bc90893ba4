"""The content of a controller text, as the judge reads it.

These are the commands listed in the header, the sequences of moves, and the dwells, outputs and barriers
between them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.decisions import KeptTo, Permitted, Register, Searched, Shifted, Value, Watch
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
    """The first line of a controller text that differs from what yarcc emits.

    Attributes:
        line: number of the line, from 1.
        reason: the difference in words.
        code: code of the finding.
    """

    line: int
    reason: str
    code: str = "Y1151"


@frozen
class Entry:
    """A line `; command` in the header's map, which says which move lines belong to a step of the program.

    Attributes:
        at: number of this line in the text.
        step: index of the step in the program.
        index: the command's label; empty without one.
        name: the command's name.
        source_line: line in the source.
        first: first move line in the text, from 1; None without moves.
        last: last move line in the text; None without moves.
        blend: number of segments in which the command flows into the next one, half of them before its end
            and half after; None if it ends at rest.
        any_jerk: True if its motion profile has no jerk limit.
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
    """Lines to send to the controller: one line, or neighbouring move lines joined by line feeds.

    Attributes:
        first: number of the first line in the text.
        text: the lines.
    """

    first: int
    text: str

    def numbered(self) -> Iterator[tuple[int, str]]:
        """Yield each line with its number in the text."""
        yield from enumerate(self.text.split("\n"), self.first)


@frozen
class Put:
    """An assignment to a variable.

    Attributes:
        line: number of the line in the text.
        variable: the controller's variable.
        value: the value assigned.
        synchronous: True if it happens when the move of the next line begins; False if at rest.
    """

    line: int
    variable: str
    value: float
    synchronous: bool = False


@frozen(eq=False)
class Run:
    """One spline sequence: the move lines between two settings of the segment time TM.

    Attributes:
        segment_ms: TM [ms], exact.
        tm_line: number of the line that sets TM.
        points: (M, n) printed numbers [deg or mm].
        lines: (M,) numbers of the move lines in the text.
        puts: outputs that are set between the move lines, during the motion.
    """

    segment_ms: float
    tm_line: int
    points: Array
    lines: NDArray[np.int64]
    puts: tuple[Put, ...] = ()

    @property
    def segment(self) -> float:
        """Segment time TM [s]."""
        return self.segment_ms * MS

    @property
    def duration(self) -> float:
        """Duration of the sequence [s]: a segment for each move line, and one more at each end (TUM 289)."""
        return (len(self.lines) + 2) * self.segment


@frozen
class Dwelt:
    """A DWELL: the sequence ends, and the robot stands still for `milliseconds` more."""

    line: int
    milliseconds: float


@frozen
class Barred:
    """A barrier, at which the program waits for the runtime, as listed in the header's map.

    Attributes:
        line: number of the line in the text.
        kind: kind of the barrier, such as `wait` or `when`.
        step: index of the step in the program.
        condition: the condition as written, or -.
        timeout: longest wait [s]; None: no limit.
        name: name of the input, or the words for the operator.
        decided: for a `when`, its condition; for a `set`, the value assigned; for a `wait`, its condition,
            but None if it waits for one value of one input.
        again: True if the condition is decided with the input values that an earlier decision has read.
        register: for a `set`, the register assigned; for a `hold`, the register for the operator's answer.
        output: for a `set`, the variable of the output assigned, or those of all bits of a group.
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
    """A slow RAPID to the current position: `point` (n,) [deg or mm]."""

    line: int
    point: Array


@frozen(eq=False)
class Start:
    """Start of the motion in a controller text.

    Attributes:
        line: number of the line in the text.
        printed: (n,) joint positions [deg or mm]; None if the text doesn't print them, so that they must be
            computed by `Reader.start`.
    """

    line: int
    printed: Array | None


@frozen(eq=False)
class ControllerText:
    """The actions that a controller text makes the controller do, with the exact lines to send.

    Attributes:
        header: the header.
        entries: the commands in the map, with their lines.
        start: start of the motion.
        course: the actions in order.
        outputs: variables of outputs, with the values they take after the guard has stopped the motion.
        decimals: largest number of decimals in a move line.
        quantum: step size of segment times in the controller [s].
        registers: integers that the runtime keeps, with their ranges and first values.
        watches: inputs that stop the motion while they have a stated value.
        searches: motions that an input ends.
        offsets: branches that are planned and proved when the program runs, in a shifted frame.
        allows: pairs of bodies that may touch, by motion.
        keeps: rules (KEEP) that motions respect.
        own: further content that only texts for this kind of controller have.
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
    offsets: tuple[Shifted, ...] = ()
    allows: tuple[Permitted, ...] = ()
    keeps: tuple[KeptTo, ...] = ()

    @property
    def target(self) -> str:
        """Name of the target in the header."""
        return self.header.target

    @property
    def runs(self) -> tuple[Run, ...]:
        """The sequences of moves."""
        return tuple(item for item in self.course if isinstance(item, Run))

    @property
    def schedule(self) -> Schedule:
        """Start of each item of the course, and duration of the whole text."""
        return schedule_of(_part(item) for item in self.course)


Assignment = tuple[int | None, str, float]
"""Line of the text (None: in the PLC of safe values), variable, value."""


def assignments_of(text: ControllerText) -> Iterator[Assignment]:
    """Yield the assignments of the text to outputs, in the order of its lines."""
    for variable, value in text.outputs:
        yield None, variable, value
    for item in text.course:
        match item:
            case Put(line=line, variable=variable, value=value):
                yield line, variable, value
            case Run(puts=puts):
                yield from ((put.line, put.variable, put.value) for put in puts)


def _part(item: Run | Dwelt | Put | Barred | Stood) -> Part:
    """Return the time that an action of the text takes [s], or the mark of a wait, a branch or a loop."""
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
