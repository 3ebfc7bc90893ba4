"""What the checks need to know besides the text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace

from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.memory import NO_MEMORY, Memory
from yarclang.robot.model import Robot
from yarclang.semantics.motions.trajectory_file import TrajectoryFile
from yarclang.semantics.names.scope import Scope
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import FrameName, Module, Statement, Time
from yarclang.units import Kind, Unit


@frozen(eq=False)
class GivenCell:
    """The cell that a program keeps to whether or not a CELL line names it.

    Attributes:
        path: the file, as messages call it.
        loaded: the cell and the findings of its file.
        giver: who names the file, for messages: `yarc.toml` or `the command line`.
        remedy: what to change there, for the help of a finding.
        source: the file that names the cell; None for the command line.
        span: where it does.
    """

    path: str
    loaded: Result[Cell]
    giver: str
    remedy: str
    source: SourceFile | None = None
    span: Span | None = None

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """The findings of the file; one that says that it can't be read stands where the file is named."""
        return tuple(
            one if one.source is not None else replace(one, source=self.source, span=self.span)
            for one in self.loaded.diagnostics
        )


@frozen
class Context:
    """The robot, the profiles that the planner has, where the robot stands, and how a module is found: `load` gives the module of a
    name, or a finding.

    `start` (n,) [rad or m] holds whatever the program says, `fallback_start` where it doesn't say.
    """

    robot: Robot
    profiles: tuple[str, ...]
    start: Array | None = None
    fallback_start: Array | None = None
    load: Callable[[str], Result[Module]] | None = None
    load_cell: Callable[[str, SourceFile | None], Result[Cell]] | None = None
    """Gives the cell of a path as it stands in a module's file (None: in the program); the same one for the same file."""
    load_table: Callable[[str, SourceFile | None], Result[TrajectoryFile]] | None = None
    """Gives the trajectory file of a path as it stands in a module's file (None: in the program); the same one as long as the file doesn't change."""
    cell: GivenCell | None = None
    """The cell that the command line or yarc.toml names."""
    index_needed: bool = True
    """Whether a command needs an index (the live interpreter does without)."""
    memory: Memory = NO_MEMORY
    """Keeps the steps of commands."""
    enough: int | None = None
    """Lines in loops and SUBs after which a loop makes no further round; None: all are carried out."""


@frozen
class Defaults:
    """What a DEFAULT line gives to the lines that leave it out; `statement` is the line itself.

    `scope` is that of its file. `has_bad_time` says that it gave a motion time that isn't one, which was said there.
    """

    scope: Scope
    statement: Statement | None = None
    moving: FrameName | None = None
    time: Time | None = None
    units: Mapping[Kind, Unit] = field(default_factory=dict)
    base: FrameName | None = None
    has_bad_time: bool = False
