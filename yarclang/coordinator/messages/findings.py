"""Findings as messages: what `yarc check --format json` says of one, and the line of the source that it is about."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message
from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.findings import Severity
from yarclang.source import SourceFile, Span


class FindingEdit(Message):
    """Replace what stands between two places by a text."""

    line: int
    column: int
    end_line: int
    end_column: int
    text: str


class FindingFix(Message):
    """A change of the source that removes the finding."""

    title: str
    edits: tuple[FindingEdit, ...]


class Finding(Message):
    """One finding. Lines and columns count from 1; `end_column` lies behind the last character."""

    file: str | None
    line: int | None
    column: int | None
    end_line: int | None
    end_column: int | None
    severity: Severity
    code: str
    message: str
    help: str | None
    fix: FindingFix | None
    text: str | None = None
    """The line that it is about."""


def finding_message(one: Diagnostic) -> Finding:
    """Return a finding as a message."""
    from yarclang.report.finding import finding_json  # brings in click

    text = one.source.line(one.span.line) if one.source is not None and one.span is not None else None
    content = finding_json(one)
    fix = content.pop("fix")
    made = None
    if fix is not None:
        edits = tuple(FindingEdit(**edit) for edit in fix["edits"])
        made = FindingFix(title=fix["title"], edits=edits)
    return Finding(**content, fix=made, text=text)


def finding_messages(found: tuple[Diagnostic, ...]) -> tuple[Finding, ...]:
    """Return findings as messages."""
    return tuple(map(finding_message, found))


def finding_of(message: Finding) -> Diagnostic:
    """Return the finding that a message tells; of its source only the line that it is about is known."""
    source = None if message.file is None else SourceFile(message.file, "")
    span = None
    if message.file is not None and message.line is not None:
        source = SourceFile(message.file, "\n" * (message.line - 1) + (message.text or "") + "\n")
        span = Span(
            message.line,
            message.column or 1,
            message.end_line or message.line,
            message.end_column or message.column or 1,
        )
    fix = None
    if message.fix is not None:
        edits = tuple(
            Edit(Span(one.line, one.column, one.end_line, one.end_column), one.text)
            for one in message.fix.edits
        )
        fix = Fix(message.fix.title, edits)
    level = message.severity
    return Diagnostic(message.code, message.message, source, span, message.help or "", fix, level=level)


def findings_of(messages: tuple[Finding, ...]) -> tuple[Diagnostic, ...]:
    """Return the findings that messages tell."""
    return tuple(map(finding_of, messages))
