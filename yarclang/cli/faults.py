"""A fault of a run as a finding at the command that it is about."""

from __future__ import annotations

from typing import Protocol

import click

from yarclang.diagnostics import Diagnostic
from yarclang.report.finding import finding_text
from yarclang.source import SourceFile, Span


class Placed(Protocol):
    """A place in a source, as far as the source is known; else `note` says why not."""

    @property
    def file(self) -> str:
        """Empty where the source isn't known."""

    @property
    def line(self) -> int:
        """From 1."""

    @property
    def column(self) -> int:
        """From 1."""

    @property
    def end_column(self) -> int:
        """Behind the last character."""

    @property
    def text(self) -> str:
        """The line."""

    @property
    def note(self) -> str:
        """Why the source isn't known; of a command in a module, the module's line."""


def fault_text(code: str, what: str, remedy: str, where: Placed | None) -> str:
    """A fault with its place, the source line and the remedy; where the source isn't known, the line that the text gives it."""
    if where is not None and where.file:
        # of the whole source only this line is known, and no other is shown
        source = SourceFile(where.file, "\n" * (where.line - 1) + where.text + "\n")
        span = Span.on_line(where.line, where.column, where.end_column)
        lines = [
            finding_text(Diagnostic(code, what, source, span)),
            *([f"  {where.note}"] if where.note else []),
        ]
        return "\n".join((*lines, *([f"  help: {remedy}"] if remedy else [])))
    severity = click.style(f"error {code}".rstrip(), fg="red", bold=True)
    lines = [f"{severity}: {what}"]
    if where is not None:
        lines.append(
            f"  in line {where.line} of its source, by the controller text's own comments: {where.note}"
        )
    if remedy:
        lines.append(f"  help: {remedy}")
    return "\n".join(lines)
