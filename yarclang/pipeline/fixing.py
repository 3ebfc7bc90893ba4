"""Apply fixes to a program's text until none is left. Each fix is first tried, and must not break the
program.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.findings import SYNTAX, family_of
from yarclang.frozen import frozen
from yarclang.hir import Gap, Origin, Program
from yarclang.identity import fingerprint
from yarclang.pipeline.checking import Checked
from yarclang.progress import part
from yarclang.source import SourceFile, Span

MOST_ROUNDS = 20
"""Largest number of rounds of applying fixes. Without a limit, two fixes could trigger each other endlessly.
"""

_SAME = 1e-9
"""Control points that differ by less count as equal [rad or m]."""

_LINE_END = re.compile(r"\r\n|\r|\n")


@frozen(eq=False)
class Fixed:
    """A program's text with its fixes applied, the remaining findings, and the titles of the applied
    fixes.
    """

    text: str
    checked: Checked
    applied: tuple[str, ...]


def fixed(
    checked: Checked, check: Callable[[SourceFile], Checked], is_wanted: Callable[[Diagnostic], bool]
) -> Fixed:
    """Apply the fixes of the wanted findings to a program's text.

    A fix is kept only if the new text can be parsed, has no new error, and no longer has the finding. If the
    finding was no error, the new text must also do the same as before: the curves of all motions must be the
    same or, if the program isn't planned, its steps. If the text before the fix couldn't be parsed, the new
    text may have new errors of meaning, since the syntax errors have hidden them.

    Args:
        checked: findings in the current text; its source must exist.
        check: function that checks another text of the file.
        is_wanted: function that returns True if the fix of a finding is to be applied.
    """
    assert checked.source is not None
    applied: list[str] = []
    refused: set[tuple[str, str, str]] = set()
    for _ in range(MOST_ROUNDS):
        source = checked.source
        assert source is not None
        open_ = [finding for finding in _fixable(checked, is_wanted) if _key(finding, source) not in refused]
        if not open_:
            break
        # Fix syntax errors first: they hide other errors in their lines.
        chosen = apart([finding for finding in open_ if _uncovers(finding)] or open_)
        count = f"{len(chosen)} fixes" if len(chosen) > 1 else "a fix"
        with part(f"trying {count}"):
            together = _tried(checked, chosen, check)
        if together is not None:
            checked = together
            applied += [finding.fix.title for finding in chosen if finding.fix]
            continue
        for number, finding in enumerate(chosen, 1):
            with part(f"trying fix {number} of {len(chosen)}"):
                alone = _tried(checked, [finding], check) if len(chosen) > 1 else None
            if alone is None:
                refused.add(_key(finding, source))
                continue
            checked = alone
            applied += [finding.fix.title] if finding.fix else []
            break  # the applied edits have moved the places of the other findings
    assert checked.source is not None
    return Fixed(checked.source.text, checked, tuple(applied))


def is_repair(finding: Diagnostic) -> bool:
    """Return True if a finding has a fix that can be applied without asking a person."""
    return finding.fix is not None and not finding.fix.by_choice


def _uncovers(finding: Diagnostic) -> bool:
    return finding.fix is not None and finding.fix.uncovers


def _fixable(checked: Checked, is_wanted: Callable[[Diagnostic], bool]) -> list[Diagnostic]:
    name = checked.source.name if checked.source else ""
    return [
        one
        for one in checked.diagnostics
        if one.fix is not None and one.source is not None and one.source.name == name and is_wanted(one)
    ]


def _key(finding: Diagnostic, source: SourceFile) -> tuple[str, str, str]:
    """Return a key by which a finding is recognized even if its line has moved."""
    line = source.line(finding.span.line) if finding.span else ""
    return finding.code, line, finding.fix.title if finding.fix else ""


def apart(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return findings whose fixes can be applied together: each finding whose edits don't overlap with those
    of an earlier one.
    """
    chosen: list[Diagnostic] = []
    edits_so_far: list[Edit] = []
    for one in findings:
        edits = one.fix.edits if one.fix else ()
        if any(_touch(edit, other) for edit in edits for other in edits_so_far):
            continue
        chosen.append(one)
        edits_so_far += edits
    return chosen


def _touch(edit: Edit, other: Edit) -> bool:
    """Return True if two edits overlap, or insert text at the same place."""
    first, second = sorted((edit.span, other.span))
    return (second.line, second.column) <= (first.end_line, first.end_column)


def edited(source: SourceFile, fixes: Iterable[Fix]) -> str:
    """Apply edits that don't overlap to a text. The kind of the line ends doesn't change, and a line end that
    is missing at the end of the text stays missing.
    """
    text = source.text
    starts = [0, *(end.end() for end in _LINE_END.finditer(text))]

    def offset(line: int, column: int) -> int:
        return min(starts[line - 1] + column - 1, len(text)) if line <= len(starts) else len(text)

    pieces: list[str] = []
    end_at = 0
    for edit in sorted((edit for fix in fixes for edit in fix.edits), key=lambda edit: edit.span):
        span = edit.span
        pieces += (text[end_at : offset(span.line, span.column)], edit.text)
        end_at = offset(span.end_line, span.end_column)
    return "".join((*pieces, text[end_at:]))


def _tried(
    before: Checked, chosen: Sequence[Diagnostic], check: Callable[[SourceFile], Checked]
) -> Checked | None:
    """Return the result of applying some fixes to a program; None if they break the program, or don't remove
    their findings.
    """
    assert before.source is not None
    text = edited(before.source, [one.fix for one in chosen if one.fix])
    if text == before.source.text:
        return None
    after = check(SourceFile(before.source.name, text))
    had, has = _counted(before), _counted(after)
    errors = {one.code for one in (*before.diagnostics, *after.diagnostics) if one.is_error}
    if all(map(_uncovers, chosen)):
        errors = {code for code in errors if family_of(code) == SYNTAX}
    if any(has[code] > had[code] for code in errors):
        return None
    # Compare codes together with messages: an edit may remove several findings with one code, or reveal
    # another one.
    said, says = _messages(before), _messages(after)
    if any(says[key] >= said[key] for key in _said_of(chosen)):
        return None
    if not any(one.is_error for one in chosen) and not _does_the_same(before, after):
        return None
    return after


def _messages(checked: Checked) -> Counter[tuple[str, str]]:
    return _said_of(checked.diagnostics)


def _said_of(findings: Iterable[Diagnostic]) -> Counter[tuple[str, str]]:
    return Counter((one.code, one.message) for one in findings)


def _counted(checked: Checked) -> Counter[str]:
    return Counter(one.code for one in checked.diagnostics)


def _does_the_same(before: Checked, after: Checked) -> bool:
    if before.program is None or after.program is None:
        return before.program is after.program
    if before.plan is None or after.plan is None:
        return before.plan is after.plan and _steps(before.program) == _steps(after.program)
    if _steps(before.program) == _steps(after.program):
        return True
    motions, other = before.plan.motions, after.plan.motions
    return len(motions) == len(other) and all(
        first.step == second.step
        and abs(first.curve.segment - second.curve.segment) < _SAME
        and first.curve.points.shape == second.curve.points.shape
        and bool((np.abs(first.curve.points - second.curve.points) < _SAME).all())
        for first, second in zip(motions, other, strict=True)
    )


def _steps(program: Program) -> str:
    """Return a hash of a program's actions, independent of its commands' indices."""
    nobody = Origin("", "", program.source, Span(1, 1, 1, 1))
    steps = tuple(step if isinstance(step, Gap) else replace(step, origin=nobody) for step in program.steps)
    return fingerprint(replace(program, steps=steps))
