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
"""How messages speak of a line's values of a kind."""


@dataclass(slots=True)
class Line:
    """A motion command that is being read: where it stands, and what it needs to be understood.

    `values` are what its way-points mean, `units` its units and DEFAULT's (None: they are wrong, which was said).
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
        """Tell that a unit is missing, once a line."""
        if kind in self._told:
            return
        self._told.add(kind)
        self.findings.add_error(missing_unit(kind, WHAT[kind]), span)
