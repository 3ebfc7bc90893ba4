"""A motion command that is being read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from yarclang.commands.spec import Values
from yarclang.diagnostics import Collector
from yarclang.robot.model import Robot
from yarclang.semantics.context import Defaults
from yarclang.semantics.names.commands import ResolvedName
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.values.amounts import missing_unit
from yarclang.source import Span
from yarclang.syntax.ast import Statement
from yarclang.units import Kind, Unit

WHAT: Mapping[Kind, str] = {"length": "the lengths", "angle": "the angles", "time": "the time"}
"""Words for values of a kind in messages."""


@dataclass(slots=True)
class Line:
    """A motion command that is being read.

    Attributes:
        statement: the command.
        name: its resolved name.
        values: the kind of values of its waypoints.
        robot: the robot.
        defaults: the values of the DEFAULT line of its file.
        scope: the names in scope at this line.
        units: units of the line and of DEFAULT; None if they are wrong, which was already reported.
        findings: the findings of its file.
    """

    statement: Statement
    name: ResolvedName
    values: Values
    robot: Robot
    defaults: Defaults
    scope: Scope
    units: Mapping[Kind, Unit] | None
    findings: Collector
    _told: set[str] = field(default_factory=set)

    def missing(self, kind: Kind, span: Span) -> None:
        """Report that a unit is missing. Each kind of unit is reported once for a line.

        Args:
            kind: the kind of unit.
            span: place of the finding.
        """
        if kind in self._told:
            return
        self._told.add(kind)
        self.findings.add_error(missing_unit(kind, WHAT[kind]), span)
