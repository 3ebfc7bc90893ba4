"""The files of a program while they are read: the program itself and its modules."""

from __future__ import annotations

from dataclasses import dataclass, field

from yarclang.diagnostics import Collector
from yarclang.semantics.context import Defaults
from yarclang.semantics.names.scope import Scope
from yarclang.syntax.ast import Block, Statement, Value


@dataclass(slots=True, eq=False)
class File:
    """A file (the program or a module) whose lines are being carried out.

    Attributes:
        findings: collects the findings of the file.
        scope: names of the file.
        defaults: the values of its DEFAULT line.
        is_program: True for the program, False for a module.
        seen: for each word of a declaration, the first line so far that begins with it.
        command_seen: True after the first command.
    """

    findings: Collector
    scope: Scope
    defaults: Defaults
    is_program: bool
    seen: dict[str, int] = field(default_factory=dict)
    command_seen: bool = False


@dataclass(slots=True, eq=False)
class Sub:
    """A declared SUB.

    Attributes:
        block: lines of the SUB.
        scope: the names that its file had declared before the SUB.
        file: the file with the SUB, with its DEFAULT and findings.
    """

    block: Block
    scope: Scope
    file: File

    @property
    def name(self) -> str:
        """Name of the SUB in upper case."""
        return values_of(self.block.head)[0].text.upper()


def values_of(statement: Statement) -> list[Value]:
    """Return the values of all waypoints of a line. For a line without motion, these are the values after
    its first word.
    """
    return [value for waypoint in statement.waypoints for value in waypoint.values]
