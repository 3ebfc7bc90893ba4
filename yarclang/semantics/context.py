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
    """The cell that the command line or yarc.toml gives to a program, with or without a CELL line.

    Attributes:
        path: the cell's file, as shown in messages.
        loaded: the cell and the findings of its file.
        giver: who names the file, for messages: `yarc.toml` or `the command line`.
        remedy: what to change there, for the help of a finding.
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
        start: (n,) [rad or m] start that overrides a START line; None without one.
        fallback_start: (n,) [rad or m] start of a program without a START line.
        load: function that takes a module's name, and returns the module, or a finding.
        load_cell: function that takes a path and the module with the line that names it (None: the program),
            and returns the cell at this path. It returns the same object for the same file.
        load_table: function that takes a path and the module with the line that names it (None: the program),
            and returns the trajectory file at this path. It returns the same object as long as the file
            doesn't change.
        cell: the cell that the command line or yarc.toml names.
        index_needed: True if every command needs an index; False in the live interpreter.
        memory: cache for the steps of commands.
        enough: number of lines in loops and SUBs after which a loop starts no further round; None: no limit.
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
    """What a DEFAULT line gives to lines that don't say it themselves.

    Attributes:
        scope: names of the file.
        statement: the DEFAULT line; None without one.
        moving: the moving frame.
        time: the motion time.
        units: the units by kind.
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
