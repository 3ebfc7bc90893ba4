"""A job for streaming: the lines of a program, the time of each line, and the command to which each line
belongs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from yarclang.decisions import Register, Searched, Shifted, Value, Watch
from yarclang.lasting import NO_TIME, Lasting
from yarclang.robot.model import Array, Robot


@dataclass(frozen=True, slots=True)
class JobCommand:
    """A motion command and its time of execution.

    Program time counts both branches of each WHEN, one after the other.

    Attributes:
        index: the command's label, such as P0010; may be empty.
        name: the command's name.
        source_line: line of the command in the program's source.
        begins: program time at which the command begins [s].
        ends: program time at which the command ends [s].
        clock: latest time after the start of the program at which the command begins, apart from waits of
            unknown length [s]. It counts only the longer branch of each WHEN.
    """

    index: str
    name: str
    source_line: int
    begins: float
    ends: float
    clock: float

    @property
    def title(self) -> str:
        """Return the command's label and name, such as `P0010 MOVEL_RPY_LSPB`, or the name alone."""
        return f"{self.index} {self.name}" if self.index and self.index != "-" else self.name


def clock_at(commands: Sequence[JobCommand], time: float) -> float:
    """Return the time [s] that a run needs at most to reach a program time, without waits of unknown length.

    Args:
        commands: the motions of the program.
        time: program time, which counts both branches of each WHEN, one after the other [s].
    """
    command = next((one for one in commands if time <= one.ends), commands[-1] if commands else None)
    return time if command is None else time + command.clock - command.begins


@dataclass(frozen=True, slots=True)
class Barrier:
    """The barrier between two legs of a program, which are streamed separately. At a barrier the robot waits
    for an input or the operator, or branches of the program divide or join.

    Attributes:
        kind: wait, hold, when, else, end, loop, next, exit, endloop, set, say, stop or abort.
        variable: variable of the input for which a wait waits.
        value: value of `variable` that ends a wait.
        timeout: time limit of a wait [s]; None without a limit.
        name: name of the input, or text for the operator.
        label: label of the command.
        source_line: line of the command in the program's source.
        decided: condition of a `when`, or of a wait without `variable`; for a `set`, the number that
            `register` or `output` gets.
        again: True if the condition is evaluated with the values that the last `when` has read.
        register: register that a `set` changes.
        word: name of the command; OF for a `when` inside a CASE.
        output: output that a `set` changes.
        offset: frame that is shifted in the first branch of a `when`.
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
    offset: Shifted | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """The position of a leg in its program. `begun` is True if legs before it were started; `leads_to` is the
    title of the barrier at the leg's end (empty if the leg ends the program).
    """

    begun: bool
    leads_to: str


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """A leg of a program: the lines that are streamed up to a barrier, and this barrier.

    `ends` and `clock` don't include waits of unknown length.

    Attributes:
        job: the lines; None if the leg has none.
        barrier: barrier at the end of the leg; None at the program's end.
        ends: time at which the leg ends [s of the job], counting both branches of each WHEN, one after the
            other.
        clock: latest time at which the leg ends [s], counting only the longer branch of each WHEN passed
            before.
    """

    job: Job | None
    barrier: Barrier | None
    ends: float = 0.0
    clock: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A certified program, ready to be streamed.

    Attributes:
        name: name of the program, for people.
        robot: the robot that the program is for.
        lines: lines of the motion that are sent to the controller, in order.
        times: (len(lines),) program time of each line [s]: the time at which the motion towards the line's
            point begins, or at which its dwell begins. A line that takes no time has the time of the next
            line that takes some. Program time counts motions and dwells, and both branches of each WHEN, one
            after the other.
        commands: the motions, in order.
        start: (n,) position where the program starts [rad or m].
        end: (n,) position where the program ends [rad or m].
        slack: (n,) allowed deviation of each joint from the start [rad or m].
        segment: shortest segment time [s].
        duration: program time at which the last line has been executed [s].
        capacity: number of lines that surely fit into the controller's buffer.
        guarded: True if the controller itself holds the motion when this computer falls silent.
        text: the whole controller text.
        source: source text of the program, or empty.
        certificate: what was proved, as plain JSON text.
        offset: program time at which this job begins, if it is only a part of a program [s].
        clock: latest time at which this job begins apart from waits of unknown length, counting only the
            longer branch of each WHEN passed before [s].
        behind: time from the end of this job to the end of the program along the longest branches, apart from
            waits of unknown length [s].
        lasting: shortest and longest duration of the program, and the numbers of its waits.
        outputs: variables of outputs, and their values at any stop, hold or fault.
        sets: for each line that sets a variable: row in `lines`, variable, value.
        dwells: for each line with a dwell: row in `lines`, duration [s].
        legs: for a program with barriers, its parts between barriers, which are streamed in sequence; else
            empty.
        part: for the job of a leg that is being performed, its position in the program; else None.
        registers: for a program with barriers, the integer variables of the program.
        watches: inputs that hold the motion while they have a certain value.
        searches: for a program, the motions that inputs end.
        search: for a leg, the motion that an input ends.
        own: additional data that only the robot's kind of controller uses.
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
        """Return the largest number of lines per second that the controller executes during the job."""
        return 1.0 / self.segment

    @property
    def fits(self) -> bool:
        """Return True if the controller's buffer has room for all lines, so that all are loaded before the
        job begins.
        """
        return len(self.lines) <= self.capacity

    @property
    def longest_dwell(self) -> float:
        """Return the duration of the longest dwell [s]; 0 if there is none."""
        return max((seconds for _, seconds in self.dwells), default=0.0)

    def time_of(self, executed: int) -> float:
        """Return the program time [s] at which `executed` lines have been executed."""
        if executed >= len(self.lines):
            return self.duration
        return float(self.times[max(executed, 0)])

    def command_at(self, time: float) -> JobCommand | None:
        """Return the command that is executed at a program time [s]; None if there is none."""
        if not self.commands:
            return None
        ends = np.array([command.ends for command in self.commands])
        return self.commands[min(int(np.searchsorted(ends, time, side="right")), len(self.commands) - 1)]


@dataclass(frozen=True, slots=True)
class Papers:
    """Documents that are stored with a job in its log: the program's text and the certificate as JSON."""

    source: str = ""
    certificate: str = ""


NO_PAPERS = Papers()
