"""What is streamed: a program's lines, when each of them is executed, and which command it belongs to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.robot.model import Array, Robot


@dataclass(frozen=True, slots=True)
class JobCommand:
    """A motion command and when it is executed, from `begins` to `ends` [s of the program]."""

    index: str
    name: str
    source_line: int
    begins: float
    ends: float

    @property
    def title(self) -> str:
        """`P0010 MOVEL_RPY_LSPB`, or the name alone."""
        return f"{self.index} {self.name}" if self.index and self.index != "-" else self.name


@dataclass(frozen=True, slots=True)
class Barrier:
    """What stands between two legs of a program: it waits for an input or the operator, or its ways part or meet.

    `kind` is wait, hold, when, else or end; `variable` is compared with `value`; `name` is the input's, or the operator's
    text; `label` and `source_line` are the command's. `timeout` is in s (None: for ever).
    """

    kind: str
    variable: str
    value: float
    timeout: float | None
    name: str
    label: str
    source_line: int


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """What is streamed up to a barrier (None: nothing but outputs and dwells could stand there, and none does), and the barrier
    behind it (None: the program's end).
    """

    job: Job | None
    barrier: Barrier | None


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A certified rotary program, ready to be streamed.

    Attributes:
        name: of the program, for people.
        robot: whom it is for.
        setup: the lines before the rotary is opened, one command each.
        lines: what goes into the rotary.
        times: (len(lines),) the program time [s] at which the motion towards each line's point begins; of a line
            that doesn't move, that of the next that does.
        commands: the motions, in order.
        start: (n,) where it starts [rad or m].
        end: (n,) where it ends [rad or m].
        slack: (n,) how far off the start a joint may be [rad or m].
        segment: the shortest segment time [s].
        duration: of the whole program [s].
        words: size of the rotary.
        low: I16, the lines below which the guard PLC holds; `full`: I17.
        guarded: whether the program arms the guard.
        text: the whole controller text.
        source: the program's own text, or empty.
        certificate: what was proved, as plain JSON text.
        offset: where it begins in the program that it is a part of [s].
        outputs: variables of outputs, and what they become at any stop, hold or fault.
        sets: which lines set a variable: the row in `lines`, the variable, the value.
        longest_dwell: the longest time that a line stands still [s].
        legs: of a program with barriers, what is streamed one after the other; else empty.
    """

    name: str
    robot: Robot
    setup: tuple[str, ...]
    lines: tuple[str, ...]
    times: Array
    commands: tuple[JobCommand, ...]
    start: Array
    end: Array
    slack: Array
    segment: float
    duration: float
    words: int
    low: int
    full: int
    guarded: bool
    text: str
    source: str
    certificate: str
    offset: float = 0.0
    outputs: tuple[tuple[str, float], ...] = ()
    sets: tuple[tuple[int, str, float], ...] = ()
    longest_dwell: float = 0.0
    legs: tuple[Leg, ...] = ()

    @property
    def capacity(self) -> int:
        """How many lines surely fit into the rotary: a word an axis, and two for what stands between lines."""
        return self.words // (len(self.robot.controller.axes) + 2)

    @property
    def lines_per_second(self) -> float:
        """What it needs at its fastest."""
        return 1.0 / self.segment

    @property
    def fits(self) -> bool:
        """Whether all of it is loaded before it begins."""
        return len(self.lines) <= self.capacity

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
