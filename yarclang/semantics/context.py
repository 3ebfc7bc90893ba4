"""Inputs of the checks besides the text: robot, cell, modules, profiles and defaults."""

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
    """The cell that the command line or yarc.toml names for a program. The program needs no CELL line then.

    Attributes:
        path: the cell's file, as shown in messages.
        loaded: the cell and the findings of its file.
        giver: source of the path, as messages name it: `yarc.toml` or `the command line`.
        remedy: what to change in yarc.toml or on the command line, for the help of a finding.
        source: the file that names the cell; None for the command line.
        span: place of the path in `source`.
    """

    path: str
    loaded: Result[Cell]
    giver: str
    remedy: str
    source: SourceFile | None = None
    span: Span | None = None

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """The findings about the cell's file. A finding without a place gets the place where the file is
        named.
        """
        return tuple(
            one if one.source is not None else replace(one, source=self.source, span=self.span)
            for one in self.loaded.diagnostics
        )


@frozen
class Context:
    """The inputs of the checks besides the program's text.

    Attributes:
        robot: the robot.
        profiles: names of the planner's motion profiles.
        start: (n,) [rad or m] joint position at which the program starts. It overrides a START line; None:
            not given.
        fallback_start: (n,) [rad or m] joint position at which a program without a START line starts.
        load: function that takes a module's name, and returns the module, or a finding.
        load_cell: function that returns the cell at a path. Its arguments are the path, and the module whose
            CELL line names the path (None for the program itself). All calls for a file return the same
            object.
        load_table: function that returns the trajectory file at a path. Its arguments are the path, and the
            module whose line names the path (None for the program itself). As long as the file doesn't
            change, all calls for it return the same object.
        cell: the cell that the command line or yarc.toml names.
        index_needed: True if every command needs an index; False in the live interpreter.
        memory: cache for the steps of commands.
        enough: limit of the lines in loops and SUBs that are carried out. At the limit, a loop starts no
            further round. None: no limit.
    """

    robot: Robot
    profiles: tuple[str, ...]
    start: Array | None = None
    fallback_start: Array | None = None
    load: Callable[[str], Result[Module]] | None = None
    load_cell: Callable[[str, SourceFile | None], Result[Cell]] | None = None
    load_table: Callable[[str, SourceFile | None], Result[TrajectoryFile]] | None = None
    cell: GivenCell | None = None
    index_needed: bool = True
    memory: Memory = NO_MEMORY
    enough: int | None = None


@frozen
class Defaults:
    """The values of a DEFAULT line. They apply to each line of the file that lacks them.

    Attributes:
        scope: names of the file.
        statement: the DEFAULT line; None without one.
        moving: the moving frame.
        time: the motion time.
        units: the units, by their kind (length, angle, time).
        base: the base frame.
        has_bad_time: True if the line's motion time is wrong. The finding about it is at the DEFAULT line.
    """

    scope: Scope
    statement: Statement | None = None
    moving: FrameName | None = None
    time: Time | None = None
    units: Mapping[Kind, Unit] = field(default_factory=dict)
    base: FrameName | None = None
    has_bad_time: bool = False
