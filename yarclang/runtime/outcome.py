"""The outcome of a run."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.model import Array


@dataclass(frozen=True, slots=True)
class Concerned:
    """The command that a fault concerns. Its index (such as P0020), its name and its line in the program's
    source are taken from the controller text.
    """

    index: str
    name: str
    source_line: int


@dataclass(frozen=True, slots=True)
class Where:
    """Place of a command in the program's source.

    For a command in a module of the program, this is the place of the call.

    Attributes:
        file: the source file; empty if the source isn't known.
        line: line, from 1.
        column: first column, from 1.
        end_column: column after the last one.
        text: text of the line.
        note: reason why the source isn't known; for a command in a module, the line in the module.
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

    Attributes:
        well: True if the run ended well.
        what: reason why the run didn't end well.
        remedy: what to do.
        joints: (n,) commanded position of the robot [rad or m]; None if it isn't known.
        command: the command that was executed.
        command_index: label of this command.
        done: progress of the program [s], counting both branches of each WHEN, one after the other.
        code: for a fault, the code of the finding.
        concerns: for a fault, the command.
        where: for a fault, the place in the source; callers that know the source fill it in.
        clock: progress of the program [s], counting only the longer branch of each WHEN passed before; None
            if there are no branches.
        ways: for each WHEN that the run has passed, in order, True if its first branch was executed.
        barriers: number of passed barriers at which legs end.
        at_barrier: True if the robot stands at the next of these barriers.
        registers: names and values of registers.
        finished: True if the program has ended in one of its branches, so that nothing after the branch is
            executed.
        found: True if an input has ended a motion early.
        leaves: name of the SUB by which the robot is to retreat from its place on the path; empty for no
            retreat.
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
        """Return the progress of the program as it is reported to people [s]. Unlike `done`, it counts only
        the longer branch of each WHEN passed before.
        """
        return self.done if self.clock is None else self.clock
