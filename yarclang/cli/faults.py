"""Format faults of a run as findings at the commands where they occurred."""

from __future__ import annotations

from typing import Protocol

import click

from yarclang.diagnostics import Diagnostic
from yarclang.report.finding import finding_text
from yarclang.source import SourceFile, Span


class Placed(Protocol):
    """Interface of a place in a program's source. If the source is unknown, `note` gives the reason."""

    @property
    def file(self) -> str:
        """Path of the source; empty if unknown."""

    @property
    def line(self) -> int:
        """Line, from 1."""

    @property
    def column(self) -> int:
        """Column, from 1."""

    @property
    def end_column(self) -> int:
        """Column after the last character."""

    @property
    def text(self) -> str:
        """Text of the line."""

    @property
    def note(self) -> str:
        """Reason why the source is unknown. For a command in a module, the line of the module."""


def fault_text(code: str, what: str, remedy: str, where: Placed | None) -> str:
    """Format a fault of a run with its place, the source line and the remedy. If the source is unknown, the
    place contains the line number.
    """
    if where is not None and where.file:
        # only this line of the source is known: the lines before it are empty and aren't shown
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
