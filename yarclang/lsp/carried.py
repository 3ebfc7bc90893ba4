"""Keep showing the findings of planning in lines that an edit leaves unchanged.

They are shown until motions are planned again, so that the display doesn't flicker.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from yarclang.assist.unchanged import unchanged
from yarclang.diagnostics import Diagnostic
from yarclang.source import SourceFile, Span


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """Findings that only a later, more complete check reports.

    Attributes:
        source: the text that they are about.
        findings: the findings.
    """

    source: SourceFile
    findings: tuple[Diagnostic, ...]


def planned_alone(source: SourceFile, whole: Iterable[Diagnostic], quick: Iterable[Diagnostic]) -> Planned:
    """Return the findings of a text that only a later, more complete check reports.

    Args:
        source: the text.
        whole: findings of the later check.
        quick: findings of the earlier check.
    """
    known = {_key(one) for one in quick}
    own = (one for one in whole if one.source is not None and one.source.name == source.name)
    return Planned(source, tuple(one for one in own if _key(one) not in known))


def _key(one: Diagnostic) -> tuple[str, str, Span | None]:
    return one.code, one.message, one.span


def carried(planned: Planned, source: SourceFile) -> Iterator[Diagnostic]:
    """Yield the findings of an older text that are in unchanged lines, at their places in a newer text.

    Fixes are left out, because they belong to the older text.
    """
    same = unchanged(planned.source.lines, source.lines)
    for finding in planned.findings:
        span = finding.span
        if span is None:
            continue
        line, end_line = same.now(span.line), same.now(span.end_line)
        if line is not None and end_line is not None and end_line - line == span.end_line - span.line:
            there = span if line == span.line else Span(line, span.column, end_line, span.end_column)
            # this takes a third of the time of `replace`, and long programs have many findings
            yield Diagnostic(
                finding.code,
                finding.message,
                source,
                there,
                finding.help,
                None,
                finding.place,
                finding.level,
                finding.within,
                finding.subject,
            )
