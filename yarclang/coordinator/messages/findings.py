"""Findings as messages: as in the output of `yarc check --format json`, with the affected source line."""

from __future__ import annotations

from typing import Any

from yarclang.coordinator.messages.message import Message
from yarclang.diagnostics import Diagnostic, Edit, Fix, Within
from yarclang.findings import Severity
from yarclang.source import SourceFile, Span


class FindingEdit(Message):
    """Replacement of the text between two places."""

    line: int
    column: int
    end_line: int
    end_column: int
    text: str


class FindingFix(Message):
    """A change of the source that removes the finding."""

    title: str
    edits: tuple[FindingEdit, ...]


class FindingWithin(Message):
    """The cause of a finding in a module. The line of the finding itself is the call of the module. `file` is
    null for an installed module.
    """

    module: str
    file: str | None
    line: int
    column: int
    end_line: int
    end_column: int
    text: str
    through: tuple[str, ...]
    fix: FindingFix | None


class Finding(Message):
    """One finding. Lines and columns count from 1; `end_column` is the column after the last character."""

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
    """The source line to which the finding refers."""
    within: FindingWithin | None = None
    """The cause of the finding in a module, if the source line calls a module."""


def finding_message(finding: Diagnostic) -> Finding:
    """Return a finding as a message."""
    from yarclang.report.finding import finding_json  # imported late: it imports click

    text = (
        finding.source.line(finding.span.line)
        if finding.source is not None and finding.span is not None
        else None
    )
    content = finding_json(finding)
    fix, within = content.pop("fix"), content.pop("within", None)
    message = None
    if within is not None:
        inner = within.pop("fix")
        through = tuple(within.pop("through"))
        message = FindingWithin(**within, through=through, fix=_fix_message(inner))
    return Finding(**content, fix=_fix_message(fix), text=text, within=message)


def _fix_message(fix: dict[str, Any] | None) -> FindingFix | None:
    if fix is None:
        return None
    return FindingFix(title=fix["title"], edits=tuple(FindingEdit(**edit) for edit in fix["edits"]))


def finding_messages(findings: tuple[Diagnostic, ...]) -> tuple[Finding, ...]:
    """Return findings as messages."""
    return tuple(map(finding_message, findings))


def finding_of(message: Finding) -> Diagnostic:
    """Return the finding that a message describes. Only the affected line of its source text is known."""
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
    fix, within = _fix_of(message.fix), None
    if (there := message.within) is not None:
        lines = "\n" * (there.line - 1) + there.text + "\n"
        module = SourceFile(there.file or there.module, lines, there.module, there.file is None)
        place = Span(there.line, there.column, there.end_line, there.end_column)
        within = Within(module, place, there.through, _fix_of(there.fix))
    level = message.severity
    return Diagnostic(
        message.code, message.message, source, span, message.help or "", fix, level=level, within=within
    )


def _fix_of(fix: FindingFix | None) -> Fix | None:
    if fix is None:
        return None
    edits = (Edit(Span(one.line, one.column, one.end_line, one.end_column), one.text) for one in fix.edits)
    return Fix(fix.title, tuple(edits))


def findings_of(messages: tuple[Finding, ...]) -> tuple[Diagnostic, ...]:
    """Return the findings that messages describe."""
    return tuple(map(finding_of, messages))
