"""What is streamed: a program's lines, when each of them is executed, and which command it belongs to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from yarclang.decisions import Register, Searched, Value, Watch
from yarclang.lasting import NO_TIME, Lasting
from yarclang.robot.model import Array, Robot


@dataclass(frozen=True, slots=True)
class JobCommand:
    """A motion command and when it is executed, from `begins` to `ends` [s of the program].

    `clock` is the latest known time at which it begins [s]: `begins` counts the ways of a WHEN one after the other, of which only one is taken.
    """

    index: str
    name: str
    source_line: int
    begins: float
    ends: float
    clock: float

    @property
    def title(self) -> str:
        """`P0010 MOVEL_RPY_LSPB`, or the name alone."""
        return f"{self.index} {self.name}" if self.index and self.index != "-" else self.name


def clock_at(commands: Sequence[JobCommand], time: float) -> float:
    """Return the latest known time [s] at which a program gets to a time that counts the ways of a WHEN one after the other."""
    command = next((one for one in commands if time <= one.ends), commands[-1] if commands else None)
    return time if command is None else time + command.clock - command.begins


@dataclass(frozen=True, slots=True)
class Barrier:
    """What stands between two legs of a program: it waits for an input or the operator, or its ways part or meet.

    `kind` is wait, hold, when, else, end, loop, next, exit, endloop, set, say, stop or abort; a wait compares `variable` with `value`; `name` is the input's, or the operator's
    text; `label` and `source_line` are the command's. `timeout` is in s (None: for ever). `decided` is the condition of a when, or of a wait that has no `variable`, decided with what the last when has read if `again`;
    of a set it is the number that `register` or `output` gets. `word` is the command's name: of a when, OF in a CASE.
    """

    kind: str
    variable: str
    value: float
    timeout: float | None
    name: str
    label: str
    source_line: int
    decided: Value | None = None
    again: bool = False
    register: str = ""
    word: str = ""
    output: str = ""


@dataclass(frozen=True, slots=True)
class Part:
    """What a leg is to the program that is carried out: whether legs were `begun` before, and the title of the barrier that it leads to (empty: the end)."""

    begun: bool
    leads_to: str


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """What is streamed up to a barrier (None: nothing but outputs and dwells could stand there, and none does), and the barrier
    behind it (None: the program's end). `ends` is when it ends [s of the job], and `clock` the latest known time of that.
    """

    job: Job | None
    barrier: Barrier | None
    ends: float = 0.0
    clock: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A certified program, ready to be streamed.

    Attributes:
        name: of the program, for people.
        robot: whom it is for.
        lines: what the controller is sent of the motion, in order.
        times: (len(lines),) the program time [s] at which the motion towards each line's point begins, or the dwell of a line; of a line
            that takes no time, that of the next that does. Motions and dwells count, with the ways of a WHEN one after the other.
        commands: the motions, in order.
        start: (n,) where it starts [rad or m].
        end: (n,) where it ends [rad or m].
        slack: (n,) how far off the start a joint may be [rad or m].
        segment: the shortest segment time [s].
        duration: the last of these times [s]. `lasting` is how long the program takes.
        capacity: how many lines surely fit into the controller's buffer.
        guarded: whether the controller holds by itself when it hears no more of this computer in the middle.
        text: the whole controller text.
        source: the program's own text, or empty.
        certificate: what was proved, as plain JSON text.
        offset: where it begins in the program that it is a part of [s]; `clock` is the latest known time at which it begins, with both ways of a WHEN at once.
        behind: the known time [s] from its end to the end of the job that it is a leg of, along the longest ways.
        lasting: how long it takes, with the number of its waits.
        outputs: variables of outputs, and what they become at any stop, hold or fault.
        sets: which lines set a variable: the row in `lines`, the variable, the value.
        dwells: which lines stand still: the row in `lines`, how long [s].
        legs: of a program with barriers, what is streamed one after the other; else empty.
        part: of a leg that is carried out; else None.
        registers: of a program with barriers, the integers that it keeps while it is carried out.
        watches: inputs that hold the motion while they have a value.
        searches: of a program, its motions that inputs end; `search` is that of a leg.
        own: what else the rooms of its kind of controller need.
    """

    name: str
    robot: Robot
    lines: tuple[str, ...]
    times: Array
    commands: tuple[JobCommand, ...]
    start: Array
    end: Array
    slack: Array
    segment: float
    duration: float
    capacity: int
    guarded: bool
    text: str
    source: str
    certificate: str
    offset: float = 0.0
    outputs: tuple[tuple[str, float], ...] = ()
    sets: tuple[tuple[int, str, float], ...] = ()
    dwells: tuple[tuple[int, float], ...] = ()
    legs: tuple[Leg, ...] = ()
    clock: float = 0.0
    behind: float = 0.0
    lasting: Lasting = NO_TIME
    part: Part | None = None
    own: Any = None
    registers: tuple[Register, ...] = ()
    watches: tuple[Watch, ...] = ()
    searches: tuple[Searched, ...] = ()
    search: Searched | None = None

    @property
    def lines_per_second(self) -> float:
        """What it needs at its fastest."""
        return 1.0 / self.segment

    @property
    def fits(self) -> bool:
        """Whether all of it is loaded before it begins."""
        return len(self.lines) <= self.capacity

    @property
    def longest_dwell(self) -> float:
        """The longest time that a line stands still [s]."""
        return max((seconds for _, seconds in self.dwells), default=0.0)

    def time_of(self, executed: int) -> float:
        """The program time [s] when so many lines have been executed."""
        if executed >= len(self.lines):
            return self.duration
        return float(self.times[max(executed, 0)])

    def command_at(self, time: float) -> JobCommand | None:
        """The command that is executed at a program time [s]; None where there is none."""
        if not self.commands:
            return None
        ends = np.array([command.ends for command in self.commands])
        return self.commands[min(int(np.searchsorted(ends, time, side="right")), len(self.commands) - 1)]


@dataclass(frozen=True, slots=True)
class Papers:
    """What goes with a job into its log: the program's text and the certificate as JSON."""

    source: str = ""
    certificate: str = ""


NO_PAPERS = Papers()
