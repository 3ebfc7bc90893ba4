"""Find repairs for findings: the fix that comes with a finding, a similar name, the missing unit, or a
comment that suppresses the finding.

`yarc check --fix` may apply the fix that comes with a finding. The other repairs are for a person to choose.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from yarclang.assist.sketch import Sketch
from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.mistakes.names import with_name
from yarclang.source import SourceFile, Span
from yarclang.subjects import MissingUnit, Name
from yarclang.syntax.ast import Statement
from yarclang.syntax.lines import code_of
from yarclang.units import Kind

_USUAL: Mapping[Kind, tuple[str, str]] = {"length": ("mm", "m"), "angle": ("deg", "rad"), "time": ("s", "ms")}
_IGNORE = re.compile(r"!\s*yarc\s*:\s*ignore\s*\[[^\]]*(?=\])", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Repair:
    """A change of the program that removes a finding.

    Attributes:
        finding: the finding.
        fix: the change.
        is_preferred: True if this is most likely the wanted change.
    """

    finding: Diagnostic
    fix: Fix
    is_preferred: bool = False


def repairs_of(
    source: SourceFile, sketch: Sketch | None, finding: Diagnostic, others: Iterable[Diagnostic] = ()
) -> Iterator[Repair]:
    """Yield the repairs of a finding in a text, the most likely first.

    Args:
        source: the text with the finding.
        sketch: statements and names of the text, if it is a program.
        finding: the finding.
        others: all findings of the text.
    """
    if finding.fix is not None:
        yield Repair(finding, finding.fix, is_preferred=True)
    else:
        yield from (Repair(finding, fix, is_preferred=True) for fix in _meant(source, finding))
    if sketch is not None:
        yield from (Repair(finding, fix) for fix in _units(sketch, finding, others))
        if not finding.is_error:
            yield from (Repair(finding, fix) for fix in _suppressed(source, finding))


def _meant(source: SourceFile, finding: Diagnostic) -> Iterator[Fix]:
    """Yield fixes that replace an unknown name by a similar one."""
    if isinstance(finding.subject, Name) and finding.subject.meant:
        for name in (finding.subject.meant, *finding.subject.others):
            fix = with_name(source, finding, name)
            if fix is not None:
                yield fix


def _units(sketch: Sketch, finding: Diagnostic, others: Iterable[Diagnostic]) -> Iterator[Fix]:
    """Yield fixes that insert all missing units of a line."""
    kind = _kind(finding)
    statement = sketch.statement_at(finding.span.line) if finding.span else None
    if kind is None or statement is None or finding.span is None:
        return
    here = [one for one in others if one.span is not None and sketch.statement_at(one.span.line) is statement]
    missing = {kind, *map(_kind, here)}
    kinds = [one for one in _USUAL if one in missing]
    for choice in (0, 1):
        names = ",".join(_USUAL[each][choice] for each in kinds)
        yield Fix(f"write ({names})", (_with_units(statement, names),))


def _kind(finding: Diagnostic) -> Kind | None:
    """Return the kind of the unit that is missing according to a finding."""
    return finding.subject.kind if isinstance(finding.subject, MissingUnit) else None


def _with_units(statement: Statement, names: str) -> Edit:
    """Return the edit that writes missing units into a statement's brackets or, without brackets, after its
    time or values.
    """
    if statement.units is not None:
        end = statement.span(statement.units.place)
        place = Span(end.end_line, end.end_column - 1, end.end_line, end.end_column - 1)
        return Edit(place, f",{names}" if statement.units.items else names)
    places = [statement.name.place]
    places += [statement.moving.place] if statement.moving else []
    places += [item.place for waypoint in statement.waypoints for item in waypoint.items]
    places += [statement.time.place] if statement.time else []
    row, column = max((place.row, place.end) for place in places)
    line = statement.line + row
    return Edit(Span(line, column, line, column), f" ({names})")


def _suppressed(source: SourceFile, finding: Diagnostic) -> Iterator[Fix]:
    """Yield the fix that adds a comment to suppress the finding."""
    if finding.span is None:
        return
    line = finding.span.line
    text = source.line(line)
    title = f"suppress {finding.code} in this line"
    if (found := _IGNORE.search(text, len(code_of(text)))) is not None:
        column = found.end() + 1
        yield Fix(title, (Edit(Span(line, column, line, column), f", {finding.code}"),))
        return
    end = len(text.rstrip()) + 1
    yield Fix(title, (Edit(Span(line, end, line, len(text) + 1), f"  ! yarc: ignore[{finding.code}]"),))
