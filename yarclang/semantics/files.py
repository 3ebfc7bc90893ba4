"""The files of a program while they are read: the program itself and its modules."""

from __future__ import annotations

from dataclasses import dataclass, field

from yarclang.diagnostics import Collector
from yarclang.semantics.context import Defaults
from yarclang.semantics.names.scope import Scope
from yarclang.syntax.ast import Block, Statement, Value


@dataclass(slots=True, eq=False)
class File:
    """A file that is being read: its names, its defaults, and who collects what is wrong with it.

    `seen` has the lines of the declarations so far by their words, `command_seen` says whether there was a command.
    """

    findings: Collector
    scope: Scope
    defaults: Defaults
    is_program: bool
    seen: dict[str, int] = field(default_factory=dict)
    command_seen: bool = False


@dataclass(slots=True, eq=False)
class Sub:
    """A SUB: its text, what its file had declared before it, and that file's defaults and findings."""

    block: Block
    scope: Scope
    file: File

    @property
    def name(self) -> str:
        """Its name in upper case."""
        return values_of(self.block.head)[0].text.upper()


def values_of(statement: Statement) -> list[Value]:
    """The values of all way-points: what stands behind the name of a line that has none."""
    return [value for waypoint in statement.waypoints for value in waypoint.values]
