"""The outcome of a run."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.model import Array


@dataclass(frozen=True, slots=True)
class Concerned:
    """The command that a fault concerns: its index in the program (such as P0020), its name, and its line in
    the program's source, as the controller text states them.
    """

    index: str
    name: str
    source_line: int


@dataclass(frozen=True, slots=True)
class Where:
    """Place of a command in the program's source: `file`, line and columns (from 1, the last one exclusive),
    and the `text` of the line.

    If the source isn't known, `file` is empty, and `note` gives the reason. For a command in a module of the
    program, the line is that of the call, and `note` names the line in the module.
    """

    file: str = ""
    line: int = 0
    column: int = 0
    end_column: int = 0
    text: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Ended:
    """The outcome of a run.

    `what` is the reason if the run didn't end well, and `remedy` what to do. `joints` (n,) [rad or m] is the
    robot's commanded position (None if it isn't known), `command` the command that was executed, and `done`
    the progress of the program [s], counting both branches of each WHEN, one after the other.

    For a fault, `code` is the code of the finding, `concerns` the command, and `where` its place in the
    source, which callers that know the source fill in.

    `ways` has, for each WHEN that the run has passed, in order, True if its first branch was taken.
    `barriers` counts the passed barriers at which legs end, and `at_barrier` is True if the robot stands at
    the next of these barriers. `registers` are the names and values of registers. `finished` is True if the
    program has ended in one of its branches, so that nothing after the branch is executed. `found` is True if
    an input has ended a motion early. `leaves` is the name of the SUB by which the robot is to retreat from
    its place on the path; empty if it isn't to retreat.
    """

    well: bool
    what: str = ""
    remedy: str = ""
    joints: Array | None = None
    command: str = ""
    command_index: str = ""
    done: float = 0.0
    code: str = ""
    concerns: Concerned | None = None
    where: Where | None = None
    clock: float | None = None
    ways: tuple[bool, ...] = ()
    barriers: int = 0
    at_barrier: bool = False
    registers: tuple[tuple[str, int], ...] = ()
    finished: bool = False
    found: bool = False
    leaves: str = ""

    @property
    def reached(self) -> float:
        """Return the latest time at which a run reaches `done`, as reported to people [s]: counting only
        the longer branch of each WHEN passed before, and without waits of unknown length.
        """
        return self.done if self.clock is None else self.clock
