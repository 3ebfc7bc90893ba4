"""Convert a motion command of the text to a primitive in SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from yarclang.commands.spec import Arguments
from yarclang.diagnostics import Collector, has_errors
from yarclang.hir import Allowed, Motion, Origin, Step, Timing
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.motions.allowing import allowed_by
from yarclang.semantics.motions.goals import goals_of
from yarclang.semantics.motions.line import Line
from yarclang.semantics.motions.moved import Moved, moved_by
from yarclang.semantics.motions.options import limited
from yarclang.semantics.motions.searching import search_of
from yarclang.semantics.motions.timed import refuse_rates, stretch_span, timed_of
from yarclang.semantics.motions.times import resolve_time
from yarclang.semantics.names.commands import ResolvedName
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.parts import ALL_PARTS, refuse_parts
from yarclang.semantics.values.units import resolve_units
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
    """Convert a motion command to a step of the program, with its values in SI.

    Args:
        statement: the command.
        name: its resolved name.
        context: inputs besides the text.
        defaults: the values of the DEFAULT line of its file.
        scope: the names in scope at this line.
        findings: receives the findings.

    Returns:
        None with findings if the command has errors.
    """
    before = len(findings.found)
    own_units = resolve_units(statement, statement.units, findings) if name.values else {}
    units = {**defaults.units, **own_units} if own_units is not None else None
    tolerance, blend, search, moved = None, None, None, _NOTHING
    allowed: tuple[Allowed, ...] = ()
    if name.values is None:
        refuse_parts(statement, ALL_PARTS, findings)
        goals: tuple[object, ...] = ()
        timing = Timing(0.0)
    else:
        line = Line(statement, name, name.values, context.robot, defaults, scope, units, findings)
        moved = moved_by(line)
        allowed = allowed_by(line)
        refuse_rates(line)
        if name.spec.is_timed:
            timed = timed_of(line, context.load_table)
            if timed is None or has_errors(findings.found[before:]):
                return None
            duration = float(timed.table.times[-1]) * timed.stretch
            # The time in the line belongs to one waypoint, so a fix of the duration must not replace it.
            origin = replace(
                origin_of(statement, name.full, findings, units, moved),
                time_span=None,
                stretch_span=stretch_span(statement),
            )
            return _allowing(
                name.spec.build(Arguments(origin, (), "", Timing(duration), timed=timed)), allowed
            )
        goals = goals_of(line, moved.frames)
        timing = (
            resolve_time(statement, units, defaults, scope, findings, has_speed=name.spec.moves_frame)
            if units is not None
            else Timing(None)
        )
        timing, tolerance, blend = limited(line, timing)
        search = search_of(line, blend)
    if has_errors(findings.found[before:]):
        return None
    origin = origin_of(statement, name.full, findings, units, moved)
    said = Arguments(origin, goals, name.profile, timing, tolerance, blend, name.avoids, search=search)
    return _allowing(name.spec.build(said), allowed)


def _allowing(step: Step, allowed: tuple[Allowed, ...]) -> Step:
    """Add to a step the pairs of bodies that may touch during it. Return the same step if there are none."""
    return replace(step, allowed=allowed) if allowed and isinstance(step, Motion) else step


_NOTHING = Moved(None, None)
"""The frames of a command without values."""


def origin_of(
    statement: Statement,
    name: str,
    findings: Collector,
    units: Mapping[Kind, Unit] | None = None,
    moved: Moved = _NOTHING,
) -> Origin:
    """Return the origin of a command's step: its place in the source, its name, units and frames.

    Args:
        statement: the command.
        name: its current full name.
        findings: collector of the file's findings, which also knows the calls and loops around the command.
        units: units of the command by kind; None for s, mm and deg.
        moved: frames of the command.
    """
    moving, base = moved.links
    return Origin(
        index=_index(statement.index.text) if statement.index else "",
        name=name,
        source=findings.source,
        span=statement.head_span,
        time_span=statement.span(statement.time.place) if statement.time else None,
        time_unit=units["time"].name if units and "time" in units else "s",
        length_unit=units["length"].name if units and "length" in units else "mm",
        angle_unit=units["angle"].name if units and "angle" in units else "deg",
        end_span=_end(statement),
        name_span=statement.span(statement.name.place),
        values_span=_values(statement),
        place=findings.place,
        moving=moving,
        tool=moved.tool,
        base=base,
    )


def _index(text: str) -> str:
    """Return an index with four digits; the same object if it has four digits already."""
    listed = f"P{int(text[1:]):04d}"
    return text if text == listed else listed


def _values(statement: Statement) -> Span | None:
    if not statement.waypoints:
        return None
    first = statement.waypoints[0].values[0].place
    return Span.on_line(statement.line + first.row, first.start, first.start)


def _end(statement: Statement) -> Span:
    whole = statement.whole_span
    return Span.on_line(whole.end_line, whole.end_column, whole.end_column)
