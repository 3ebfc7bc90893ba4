"""How a run has ended."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.model import Array


@dataclass(frozen=True, slots=True)
class Concerned:
    """The command that a fault is about, as the controller's text calls it: its place, its name, its line in the source."""

    index: str
    name: str
    source_line: int


@dataclass(frozen=True, slots=True)
class Where:
    """Where that command stands: `file`, line and columns (from 1, the last one behind it), and the `text` of the line.

    Where the source isn't known, `file` is empty, and `note` says why. Of a command in a module, the line is the one that calls, and `note` the module's.
    """

    file: str = ""
    line: int = 0
    column: int = 0
    end_column: int = 0
    text: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Ended:
    """How a run has ended.

    `what` says why it didn't end well, `remedy` what to do; `joints` (n,) [rad or m] is where the robot is commanded to stand (None: not
    known), `command` what was executed, `done` how far the program was [s], with the ways of a WHEN one after the other. Of a fault, `code` is that of the finding, `concerns` the
    command that it is about, and `where` its place in the source, which whoever knows the source fills in. `ways` says of each WHEN that was passed, in order, if its first way was taken;
    `barriers` counts what was passed at which legs end, and `at_barrier` is True if the robot stands at the next of them. `registers` are their names and what they held.
    `finished` is True if the program has ended in one of its ways: nothing that stands after it is carried out. `found` is True if an input has ended a motion on its way.
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

    @property
    def reached(self) -> float:
        """The latest known time at which a run gets there [s], with both ways of a WHEN at once: what people are told."""
        return self.done if self.clock is None else self.clock
