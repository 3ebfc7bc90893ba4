"""Print findings to standard error."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable

import click

from yarclang.diagnostics import Diagnostic
from yarclang.report.finding import finding_text

MOST_ALIKE = 20
"""Largest number of warnings and notes with the same code in the same file that are written to a terminal.
For a chain of 100,000 lines there may be hundreds of them.
"""


def show_without_notes(diagnostics: Iterable[Diagnostic], file: str) -> None:
    """Write errors and warnings as `show_findings` does, but only one line about the notes.

    This is for commands that use a program which `yarc check` or yarcc has checked before.
    """
    found = list(diagnostics)
    show_findings(one for one in found if one.severity != "note")
    notes = [one for one in found if one.severity == "note"]
    if notes:
        codes = ", ".join(dict.fromkeys(one.code for one in notes))
        count = f"{len(notes)} note{'s' * (len(notes) != 1)}"
        click.echo(
            f"{count} ({codes}): yarc check {file} shows {'them' if len(notes) != 1 else 'it'}", err=True
        )


def show_findings(diagnostics: Iterable[Diagnostic], *, whole: bool = False) -> None:
    """Write findings to standard error, each with its place and the source line.

    Args:
        diagnostics: the findings, in the order of output.
        whole: True to write all of them. Otherwise only the first `MOST_ALIKE` warnings and notes with the
            same code in the same file are written, followed by the number of further ones.
    """
    left_out: dict[tuple[str, str, str], list[Diagnostic]] = {}
    counts: Counter[tuple[str, str, str]] = Counter()
    for diagnostic in diagnostics:
        name = diagnostic.source.name if diagnostic.source else ""
        alike = diagnostic.severity, diagnostic.code, name
        counts[alike] += 1
        if counts[alike] > MOST_ALIKE and not whole and diagnostic.severity != "error":
            left_out.setdefault(alike, []).append(diagnostic)
            continue
        click.echo(finding_text(diagnostic), err=True, color=False if os.environ.get("NO_COLOR") else None)
    for (severity, code, name), more in left_out.items():
        where = f" in {name}" if name else ""
        lines = [one.span.line for one in more if one.span is not None]
        between = f", lines {min(lines)} to {max(lines)}" if lines else ""
        plural = "s" * (len(more) != 1)
        click.echo(
            f"and {len(more):,} more {severity}{plural} {code}{where}{between}: yarc check --format json "
            "lists all",
            err=True,
        )
