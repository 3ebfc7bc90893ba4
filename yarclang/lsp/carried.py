"""What planning has said of the lines that an edit leaves alone: shown until it is said anew, so that nothing flickers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from yarclang.assist.unchanged import unchanged
from yarclang.diagnostics import Diagnostic
from yarclang.source import SourceFile, Span


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """Findings that only planning has brought, and the text that they are about."""

    source: SourceFile
    findings: tuple[Diagnostic, ...]


def planned_alone(source: SourceFile, whole: Iterable[Diagnostic], quick: Iterable[Diagnostic]) -> Planned:
    """Of all findings of a text those that weren't there without planning."""
    known = {_key(one) for one in quick}
    own = (one for one in whole if one.source is not None and one.source.name == source.name)
    return Planned(source, tuple(one for one in own if _key(one) not in known))


def _key(one: Diagnostic) -> tuple[str, str, Span | None]:
    return one.code, one.message, one.span


def carried(planned: Planned, source: SourceFile) -> Iterator[Diagnostic]:
    """The findings of the lines that are the same in a newer text, where they are now; without fixes, which would be those of the older one."""
    same = unchanged(planned.source.lines, source.lines)
    for one in planned.findings:
        span = one.span
        if span is None:
            continue
        line, end_line = same.now(span.line), same.now(span.end_line)
        if line is not None and end_line is not None and end_line - line == span.end_line - span.line:
            there = span if line == span.line else Span(line, span.column, end_line, span.end_column)
            # a third of the time that `replace` takes, for as many findings as a long program has
            yield Diagnostic(
                one.code,
                one.message,
                source,
                there,
                one.help,
                None,
                one.place,
                one.level,
                one.within,
                one.subject,
            )
