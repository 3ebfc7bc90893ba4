"""Workflow commands of GitHub Actions, which turn findings into annotations of lines."""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.cli.formats import path_of
from yarclang.diagnostics import Diagnostic
from yarclang.lint.registry import everything
from yarclang.report.finding import told_text

_COMMANDS = {"error": "error", "warning": "warning", "note": "notice"}


def write(files: Sequence[str], found: Sequence[Diagnostic], *, strict: bool = False) -> str:  # noqa: ARG001 (as the other formats)
    """Return one command for each finding."""
    return "".join(f"{_command(one)}\n" for one in found)


def _command(one: Diagnostic) -> str:
    properties: dict[str, object] = {}
    if one.source is not None:
        properties["file"] = path_of(one)
    span = one.shown_at
    if one.source is not None and span is not None:
        properties |= {"line": span.line, "endLine": span.end_line}
        if span.line == span.end_line:  # columns are allowed within one line only
            properties |= {"col": span.column, "endColumn": span.end_column}
    properties["title"] = f"{one.code} {everything()[one.code].name}"
    shown = ",".join(f"{key}={_property(str(value))}" for key, value in properties.items())
    return f"::{_COMMANDS[one.severity]} {shown}::{_data(told_text(one))}"


def _data(text: str) -> str:
    """Escape a message in the same way as the runner's toolkit."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    """Escape a property in the same way as the runner's toolkit."""
    return _data(text).replace(":", "%3A").replace(",", "%2C")
