"""Convert findings and edits to the Language Server Protocol."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from lsprotocol import types

from yarclang.diagnostics import Diagnostic, Edit, Within
from yarclang.lint.registry import everything
from yarclang.lsp.documents import Document
from yarclang.lsp.positions import position_in, position_of, range_of
from yarclang.memory import Lately
from yarclang.source import SourceFile, Span

_SEVERITIES = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "note": types.DiagnosticSeverity.Information,
}
_TAGS = {
    "": None,
    "unneeded": [types.DiagnosticTag.Unnecessary],
    "outdated": [types.DiagnosticTag.Deprecated],
}


def diagnostic_of(document: Document, finding: Diagnostic, encoding: str) -> types.Diagnostic:
    """Convert a finding to a diagnostic of the protocol.

    A finding in another file is shown at the beginning of the text, with its place as related information.
    The result is shared and must not be changed.
    """
    source, span = document.source, finding.span
    if finding.source is None or finding.source.name == source.name:
        if finding.within is not None:
            return _called(source, finding, finding.within, encoding)
        if span is not None and span.line == span.end_line:
            line = source.line(span.line)
            return _on_line(
                finding.code, finding.severity, finding.message, finding.help, line, span, encoding
            )
        return _diagnostic(
            finding.code, finding.severity, finding.message, finding.help, shown_range(source, span, encoding)
        )
    place = finding.source.name + (f":{span.line}" if span else "")
    location = types.Location(uri_of(finding.source.name), shown_range(finding.source, span, encoding))
    shown = _diagnostic(
        finding.code,
        finding.severity,
        f"{place}: {finding.message}",
        finding.help,
        shown_range(source, None, encoding),
    )
    shown.related_information = [types.DiagnosticRelatedInformation(location, finding.message)]
    return shown


def _called(source: SourceFile, finding: Diagnostic, within: Within, encoding: str) -> types.Diagnostic:
    """Convert a finding in a module to a diagnostic at the calling line, with the module's line as related
    information.
    """
    range_ = shown_range(source, finding.span, encoding)
    message = f"{finding.message}\n{within.text}"  # some editors don't show related information
    shown = _diagnostic(finding.code, finding.severity, message, finding.help, range_)
    there = types.Location(uri_of(within.source.name), shown_range(within.source, within.span, encoding))
    shown.related_information = [types.DiagnosticRelatedInformation(there, within.text)]
    return shown


def expect(findings: int) -> None:
    """Make room in the cache for a number of diagnostics. Most findings of a text will be the same in its
    next version.
    """
    _on_line.expect(findings)


def _made_on_line(
    code: str, severity: str, message: str, help_: str, line: str, span: Span, encoding: str
) -> types.Diagnostic:
    """Convert a finding within one line to a diagnostic. Results are cached, because an edit changes only a
    few of a long program's findings.
    """
    column = min(span.column, max(len(line), 1))  # for something missing at the end, the last character
    range_ = types.Range(
        position_in(line, span.line, column, encoding),
        position_in(line, span.line, max(span.end_column, column + 1), encoding),
    )
    return _diagnostic(code, severity, message, help_, range_)


_KEPT = 1024
"""Capacity of the cache of findings; each takes 1 to 2 kB. For texts with more findings, the capacity grows
to hold all of them.
"""

_on_line = Lately(_made_on_line, _KEPT)


def _diagnostic(code: str, severity: str, message: str, help_: str, range_: types.Range) -> types.Diagnostic:
    return types.Diagnostic(
        range=range_,
        message=message + (f"\n{help_}" if help_ else ""),
        severity=_SEVERITIES[severity],
        code=code,
        source="yarc",
        tags=_TAGS[everything()[code].tag],
    )


def shown_range(source: SourceFile, span: Span | None, encoding: str) -> types.Range:
    """Return the range at which a finding is shown.

    A finding without a place is shown in the first line; an empty place is made one character wide.
    """
    if span is None:
        end = max(len(source.line(1)), 1) + 1
        return range_of(source, Span.on_line(1, 1, end), encoding)
    range_ = range_of(source, span, encoding)
    if range_.start == range_.end:
        range_.end = position_of(source, span.line, span.column + 1, encoding)
    return range_


def text_edits(source: SourceFile, edits: Iterable[Edit], encoding: str) -> list[types.TextEdit]:
    """Convert edits of a text to those of the protocol."""
    return [types.TextEdit(range_of(source, one.span, encoding), one.text) for one in edits]


def markup(text: str, formats: Iterable[object] | None) -> types.MarkupContent:
    """Return a text in Markdown for clients that accept Markdown, and without Markdown's marks for other
    clients.
    """
    kinds = [getattr(one, "value", one) for one in formats or ()]
    if types.MarkupKind.Markdown.value in kinds:
        return types.MarkupContent(types.MarkupKind.Markdown, text)
    lines = [line for line in text.splitlines() if not line.startswith("```") and line != "---"]
    plain = re.sub(r"\*\*|`", "", "\n".join(lines))
    return types.MarkupContent(types.MarkupKind.PlainText, re.sub(r"\n{3,}", "\n\n", plain).strip())


def uri_of(name: str) -> str:
    """Return the URI of a file from its name in findings."""
    return Path(name).absolute().as_uri()
