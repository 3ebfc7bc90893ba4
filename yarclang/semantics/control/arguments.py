"""Name the arguments of a CALL in findings about the SUB: a finding about `$T` in a SUB also names the CALL
that gave T its value.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from yarclang.diagnostics import Collector, Diagnostic
from yarclang.hir import Gap, Origin, Step
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Computed, ComputedPercent, Statement, Time
from yarclang.syntax.expressions import Expression, Name, parts_of

Given = Mapping[str, str]
"""Texts that findings in a SUB show about its arguments, by the parameter's name in upper case. Each text
names the argument and the line of the CALL.
"""


def said_of_time(time: Time | None, given: Given) -> str:
    """Return a text about the arguments that determine a motion time in a SUB; empty if the time uses no
    parameter of the SUB.
    """
    items = time.items if time is not None else ()
    return _said((item for item in items if isinstance(item, Computed | ComputedPercent)), given)


def name_arguments(statement: Statement, findings: Collector, since: int, given: Given) -> None:
    """Name arguments of a CALL in the findings about a statement of the SUB: the arguments of those
    parameters that the statement uses.

    Args:
        statement: the line, in a SUB.
        findings: the findings of its file.
        since: number of the first finding about the statement.
        given: texts about the arguments of the SUB.
    """
    if not given or len(findings.found) == since:
        return
    computed = [
        item
        for item in (
            *(item for waypoint in statement.waypoints for item in waypoint.items),
            *(statement.time.items if statement.time else ()),
            *(option.argument for option in statement.options),
        )
        if isinstance(item, Computed | ComputedPercent)
    ]
    for at in range(since, len(findings.found)):
        one = findings.found[at]
        if one.span is not None:
            span = one.span
            about = (item for item in computed if _overlap(statement.span(item.place), span))
            findings.found[at] = _with(one, _said(about, given))


def name_arguments_of_times(findings: Iterable[Diagnostic], steps: Iterable[Step]) -> Iterator[Diagnostic]:
    """Yield the planner's findings. A finding about a motion time in a SUB also names the arguments that a
    CALL gave for the parameters in this time.
    """
    times: dict[tuple[SourceFile, Span, str], Origin] = {}
    for step in steps:
        if not isinstance(step, Gap) and step.origin.time_given and step.origin.time_span:
            times[step.origin.source, step.origin.time_span, step.origin.place] = step.origin
    for one in findings:
        origin = times.get((one.source, one.span, one.place)) if one.source and one.span else None
        # The fix is dropped: it would replace the parameter by a number, for all calls.
        yield one if origin is None else replace(_with(one, origin.time_given), fix=None)


def _said(items: Iterable[Computed | ComputedPercent], given: Given) -> str:
    names = dict.fromkeys(name for item in items for name in names_in(item.expression))
    return "; ".join(given[name] for name in names if name in given)


def names_in(expression: Expression) -> Iterator[str]:
    """Yield the names in an expression, in upper case."""
    if isinstance(expression, Name):
        yield expression.name
    for part in parts_of(expression):
        yield from names_in(part)


def _overlap(one: Span, other: Span) -> bool:
    first, last = (one.line, one.column), (one.end_line, one.end_column)
    return first < (other.end_line, other.end_column) and (other.line, other.column) < last


def _with(finding: Diagnostic, said: str) -> Diagnostic:
    return (
        finding
        if not said
        else replace(finding, help="; ".join(part for part in (finding.help, said) if part))
    )
