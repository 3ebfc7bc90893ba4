"""A fault of a run as a finding at the command that it is about."""

from __future__ import annotations

import click

from yarclang.diagnostics import Diagnostic
from yarclang.pipeline.origins import Origins
from yarclang.report.finding import finding_text
from yarclang.runtime.outcome import Concerned, Where
from yarclang.source import SourceFile, Span


def where_of(origins: Origins, concerned: Concerned) -> Where:
    """Where a command stands in its source, as far as the source is known."""
    origin = origins.of(concerned.index, concerned.name, concerned.source_line)
    if origin is None:
        note = origins.missing or "the program has no such command"
        return Where(line=concerned.source_line, note=note)
    span = origin.span
    end = span.end_column if span.end_line == span.line else len(origin.source.line(span.line)) + 1
    return Where(origin.source.name, span.line, span.column, end, origin.source.line(span.line))


def fault_text(code: str, what: str, remedy: str, where: Where | None) -> str:
    """A fault with its place, the source line and the remedy; where the source isn't known, the line that the text gives it."""
    if where is not None and where.file:
        # of the whole source only this line is known, and no other is shown
        source = SourceFile(where.file, "\n" * (where.line - 1) + where.text + "\n")
        span = Span.on_line(where.line, where.column, where.end_column)
        return finding_text(Diagnostic(code, what, source, span, remedy))
    severity = click.style(f"error {code}".rstrip(), fg="red", bold=True)
    lines = [f"{severity}: {what}"]
    if where is not None:
        lines.append(
            f"  in line {where.line} of its source, by the controller text's own comments: {where.note}"
        )
    if remedy:
        lines.append(f"  help: {remedy}")
    return "\n".join(lines)
