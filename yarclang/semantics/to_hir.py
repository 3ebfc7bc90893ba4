"""A command of the text to a primitive in SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from yarclang.commands.spec import Arguments
from yarclang.diagnostics import Collector
from yarclang.hir import Origin, Step, Timing
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.goals import Line
from yarclang.semantics.names import ResolvedName
from yarclang.semantics.parts import ALL_PARTS, refuse_parts
from yarclang.semantics.scope import Scope
from yarclang.semantics.times import resolve_time
from yarclang.semantics.units import resolve_units
from yarclang.source import Span
from yarclang.syntax.ast import Statement
from yarclang.units import Kind, Unit


def to_step(
    statement: Statement,
    name: ResolvedName,
    context: Context,
    defaults: Defaults,
    scope: Scope,
    findings: Collector,
) -> Step | None:
    """One command in SI.

    Returns:
        None where the command has errors; each is a finding.
    """
    before = len(findings.found)
    own_units = resolve_units(statement, statement.units, findings) if name.values else {}
    units = {**defaults.units, **own_units} if own_units is not None else None
    origin = origin_of(statement, name.full, findings, units)
    tolerance, blend = None, None
    if name.values is None:
        refuse_parts(statement, ALL_PARTS, findings)
        goals: tuple[object, ...] = ()
        timing = Timing(0.0)
    else:
        line = Line(statement, name, name.values, context.robot, defaults, scope, units, findings)
        goals = line.goals()
        timing = (
            resolve_time(statement, units, defaults, scope, findings, has_speed=name.spec.moves_frame)
            if units is not None
            else Timing(None)
        )
        timing, tolerance, blend = line.limited(timing)
        origin = replace(origin, moving=line.links[0], base=line.links[1], tool=line.tool)
    if any(found.is_error for found in findings.found[before:]):
        return None
    return name.spec.build(Arguments(origin, goals, name.profile, timing, tolerance, blend, name.avoids))


def origin_of(
    statement: Statement, name: str, findings: Collector, units: Mapping[Kind, Unit] | None = None
) -> Origin:
    """Where a command comes from."""
    return Origin(
        index=f"P{int(statement.index.text[1:]):04d}" if statement.index else "",
        name=name,
        source=findings.source,
        span=statement.head_span,
        time_span=statement.span(statement.time.place) if statement.time else None,
        time_unit=units["time"].name if units and "time" in units else "s",
        end_span=_end(statement),
        name_span=statement.span(statement.name.place),
        values_span=_values(statement),
        place=findings.place,
    )


def _values(statement: Statement) -> Span | None:
    if not statement.waypoints:
        return None
    span = statement.span(statement.waypoints[0].place)
    return Span.on_line(span.line, span.column, span.column)


def _end(statement: Statement) -> Span:
    whole = statement.whole_span
    return Span.on_line(whole.end_line, whole.end_column, whole.end_column)
