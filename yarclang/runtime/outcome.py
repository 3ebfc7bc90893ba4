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

    Where the source isn't known, `file` is empty, and `note` says why.
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
    known), `command` what was executed, `done` how far the program was [s]. Of a fault, `code` is that of the finding, `concerns` the
    command that it is about, and `where` its place in the source, which whoever knows the source fills in.
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
