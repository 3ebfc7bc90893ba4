"""Merge the error that a goal can't be reached with the warning that explains it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from yarclang.diagnostics import Diagnostic
from yarclang.findings import CATALOGUE
from yarclang.lint.registry import rules


def explained(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Merge each error with the warning that explains it: the error gets the warning's remedy. Return all
    findings; those without a partner are unchanged.

    Args:
        diagnostics: all findings. Findings about one command have the same file and first line.
    """
    findings = tuple(diagnostics)
    unreached = {_place(finding) for finding in findings if finding.is_error and _is_explained(finding)}
    if not unreached:
        return findings
    reasons: dict[tuple[str, int], Diagnostic] = {}
    explaining = {rule.finding.code for rule in rules() if rule.explains_errors}
    for finding in findings:
        if finding.code in explaining and not finding.is_error and _place(finding) in unreached:
            reasons.setdefault(_place(finding), finding)
    merged: list[Diagnostic] = []
    for finding in findings:
        reason = reasons.get(_place(finding))
        if reason is None or (finding is not reason and not _is_explained(finding)):
            merged.append(finding)
        elif finding.is_error:
            merged.append(
                replace(finding, help=f"{reason.help}: {reason.message}", fix=finding.fix or reason.fix)
            )
    return tuple(merged)


def _is_explained(finding: Diagnostic) -> bool:
    """Return True if a finding is of a kind whose reason a lint rule may give."""
    return CATALOGUE[finding.code].is_explained


def _place(finding: Diagnostic) -> tuple[str, int]:
    return (finding.source.name if finding.source else "", finding.span.line if finding.span else 0)
