"""Format findings as text and as JSON."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import click

from yarclang.diagnostics import Diagnostic, Fix, Within

_COLOURS = {"error": "red", "warning": "yellow", "note": "cyan"}
_WIDEST = 150
"""Largest number of characters of a source line that are shown."""


def finding_text(diagnostic: Diagnostic) -> str:
    """Return a finding as text for people: file:line:column, severity, code and message; then the source line
    with carets, the line of a called module that causes the finding, and the remedy.
    """
    place = ""
    if diagnostic.source is not None:
        name = "".join(one if one.isprintable() else "?" for one in diagnostic.source.name)
        place = f"{name}: "
        if diagnostic.span is not None:
            place = f"{name}:{diagnostic.span.line}:{diagnostic.span.column}: "
    severity = click.style(
        f"{diagnostic.severity} {diagnostic.code}", fg=_COLOURS[diagnostic.severity], bold=True
    )
    lines = [f"{place}{severity}: {diagnostic.message}"]
    lines += _excerpt(diagnostic)
    if diagnostic.within is not None:
        lines.append(f"  {diagnostic.within.text}")
    if diagnostic.help:
        lines.append(f"  help: {diagnostic.help}")
    return "\n".join(lines)


def _excerpt(diagnostic: Diagnostic) -> list[str]:
    """Return a finding's source line with carets below the place of the finding. Of a very long line, only
    the surroundings of this place are shown.
    """
    if diagnostic.source is None or diagnostic.span is None:
        return []
    span = diagnostic.span
    text = diagnostic.source.line(span.line).replace("\t", " ")
    if not text.strip():
        return []
    end = span.end_column if span.end_line == span.line else len(text) + 1
    start = span.column - 1
    first = max(0, start - _WIDEST // 2) if len(text) > _WIDEST else 0
    printable_line = text[first : first + _WIDEST]
    before, after = "…" * (first > 0), "…" * (first + _WIDEST < len(text))
    printable_line = "".join(character if character.isprintable() else "·" for character in printable_line)
    width = max(1, min(end - 1, first + len(printable_line)) - start)
    margin = f"{span.line:>5} | "
    carets = " " * (len(before) + start - first) + "^" * width
    colour = _COLOURS[diagnostic.severity]
    return [
        f"{margin}{before}{printable_line}{after}",
        " " * (len(margin) - 2) + "| " + click.style(carets, fg=colour),
    ]


def finding_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """Return a finding as plain data. Lines and columns count from 1, and `end_column` is the column after
    the last character.
    """
    span = diagnostic.shown_at
    return {
        "file": diagnostic.source.name if diagnostic.source else None,
        "line": span.line if span else None,
        "column": span.column if span else None,
        "end_line": span.end_line if span else None,
        "end_column": span.end_column if span else None,
        "severity": diagnostic.severity,
        "code": diagnostic.code,
        "message": diagnostic.message,
        "help": diagnostic.help or None,
        "fix": _fix_json(diagnostic.fix),
        **({} if diagnostic.within is None else {"within": _within_json(diagnostic.within)}),
    }


def _within_json(within: Within) -> dict[str, Any]:
    """Return the place in a module that causes a finding, as plain data. For an installed module there is no
    file, because users don't edit it.
    """
    span, source = within.span, within.source
    return {
        "module": source.module,
        "file": None if source.is_installed else source.name,
        "line": span.line,
        "column": span.column,
        "end_line": span.end_line,
        "end_column": span.end_column,
        "text": source.line(span.line).strip(),
        "through": list(within.through),
        "fix": _fix_json(within.fix),
    }


def _fix_json(fix: Fix | None) -> dict[str, Any] | None:
    if fix is None:
        return None
    edits = [
        {
            "line": edit.span.line,
            "column": edit.span.column,
            "end_line": edit.span.end_line,
            "end_column": edit.span.end_column,
            "text": edit.text,
        }
        for edit in fix.edits
    ]
    return {"title": fix.title, "edits": edits}


def told_text(diagnostic: Diagnostic) -> str:
    """Return a finding as text for editors and other programs: the message, the line of a called module that
    causes the finding, and the remedy.
    """
    within = diagnostic.within.text if diagnostic.within is not None else ""
    return "\n".join(part for part in (diagnostic.message, within, diagnostic.help) if part)


def count_text(diagnostics: Iterable[Diagnostic], *, notes: bool = False) -> str:
    """Return the numbers of errors, warnings and (with `notes`) notes, in words; empty if there are none."""
    counts = {"error": 0, "warning": 0, **({"note": 0} if notes else {})}
    for diagnostic in diagnostics:
        if diagnostic.severity in counts:
            counts[diagnostic.severity] += 1
    return ", ".join(f"{number} {word}{'s' * (number != 1)}" for word, number in counts.items() if number)
