"""Findings on standard error."""

from __future__ import annotations

import os
from collections.abc import Iterable

import click

from yarclang.diagnostics import Diagnostic
from yarclang.report.finding import finding_text


def show_findings(diagnostics: Iterable[Diagnostic]) -> None:
    """Write findings to standard error, each with its place and the source line."""
    for diagnostic in diagnostics:
        click.echo(finding_text(diagnostic), err=True, color=False if os.environ.get("NO_COLOR") else None)
