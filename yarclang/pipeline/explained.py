"""Merge the error about an unreachable place with the warning that explains it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from yarclang.diagnostics import Diagnostic
from yarclang.findings import CATALOGUE
from yarclang.lint.registry import rules


def explained(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return the findings. An error and the warning that explains it become one error with the warning's
    remedy.

    Args:
        diagnostics: all findings. Findings of one command have the same file and first line.
    """
    found = tuple(diagnostics)
    unreached = {_place(one) for one in found if one.is_error and _is_explained(one)}
    if not unreached:
        return found
    reasons: dict[tuple[str, int], Diagnostic] = {}
    explaining = {rule.finding.code for rule in rules() if rule.explains_errors}
    for one in found:
        if one.code in explaining and not one.is_error and _place(one) in unreached:
            reasons.setdefault(_place(one), one)
    told: list[Diagnostic] = []
    for one in found:
        reason = reasons.get(_place(one))
        if reason is None or (one is not reason and not _is_explained(one)):
            told.append(one)
        elif one.is_error:
            told.append(replace(one, help=f"{reason.help} {reason.message}", fix=one.fix or reason.fix))
    return tuple(told)


def _is_explained(one: Diagnostic) -> bool:
    """Return True if a lint rule may give the reason for a finding."""
    return CATALOGUE[one.code].is_explained


def _place(one: Diagnostic) -> tuple[str, int]:
    return (one.source.name if one.source else "", one.span.line if one.span else 0)
