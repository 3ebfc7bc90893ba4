"""Remove findings that only follow from another finding, so that each fault is reported once, where it is."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache

from yarclang.diagnostics import Diagnostic, gathered, has_errors
from yarclang.findings import Follows, Need
from yarclang.lint.registry import everything
from yarclang.progress import each
from yarclang.source import SourceFile
from yarclang.subjects import Name
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import BLOCK_ENDS, BLOCK_HEADS, DECLARATIONS

_MISPLACED = "Y0116"
"""The finding about a line that isn't allowed in a block."""

_GIVES_NAMES = ("FRAME", "FRAME_QUAT", "LET", "FUNC", "TABLE", "JOINTS", "POSE")

_WITHOUT_HEAD = "{[("
"""Characters at the beginning of lines that were probably meant as a DEFAULT but lack this word."""

_BY_DEFAULT = ("default", "unit")
"""Needs of a finding (`Finding.need`) that a DEFAULT line usually fulfils. Many lines rely on this line, so
that one mistake in it may cause many findings.
"""

_MANY = 3
_MOST_IN_A_LINE = 20
"""Largest number of findings with one code in one line. If there are more, users will look at the whole
line anyway.
"""

_LIKE = 0.7
"""Smallest similarity (difflib's ratio) at which a word counts as a misspelling of another word."""

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def without_followers(diagnostics: Iterable[Diagnostic], source: SourceFile) -> tuple[Diagnostic, ...]:
    """Return the findings without those that follow from an error in another line of the program.

    A line with an error explains unknown names elsewhere that occur in this line. A DEFAULT that can't be
    parsed explains missing units and frames. A block's first line that can't be parsed explains an END
    without a block. A wrong frame or number explains a goal that can't be reached. The catalogue lists the
    prerequisites and causes of each finding. An error is dropped only if the error that explains it stays.

    Args:
        diagnostics: all findings.
        source: the program's file.
    """
    findings = tuple(diagnostics)
    causes = _causes(findings, source)
    if not causes and not any(_need(one) in ("name", "meaning", *_BY_DEFAULT) for one in findings):
        return findings
    reasons = _Reasons(findings, causes, source)
    kept = [one for one in each(findings) if not reasons.explain(one)]
    if has_errors(findings) and not has_errors(kept):
        return findings  # every finding was explained by another one
    return _said_once(kept)


def _causes(findings: Iterable[Diagnostic], source: SourceFile) -> set[int]:
    """Return the program's lines whose errors may cause findings elsewhere. Commands whose only error is an
    unknown name are left out: they declare nothing that other lines could miss.
    """
    own = [(one, line) for one in each(findings) if (line := _line(one, source))]
    uses = {line for one, line in own if _need(one) in ("name", "meaning") and not _declares(source, line)}
    return {line for one, line in own if one.is_error} - uses


class _Reasons:
    """The lines with errors, and the names and settings that are missing elsewhere because of these errors.

    Args:
        findings: all findings.
        causes: lines whose errors may be the reason for other findings.
        source: the program's file.
    """

    def __init__(self, findings: Iterable[Diagnostic], causes: set[int], source: SourceFile) -> None:
        self._source, self._causes = source, causes
        self._wrong = {_line(one, source) for one in each(findings) if one.is_error} - {0}
        self._lines: dict[str, set[int]] = {}
        """Lines of the findings with each code; 0 for a finding in another file."""
        for one in each(findings):
            self._lines.setdefault(one.code, set()).add(_line(one, source))
        self._above = {code: min(lines - {0}, default=math.inf) for code, lines in self._lines.items()}
        hidden = {everything()[code].hides for code in self._lines} - {""}
        self._lost_name, self._lost_module = bool(hidden), "module" in hidden
        words = {line: _words(source.line(line)) for line in each(causes)}
        self._firsts = {line: _first(source.line(line)) for line in each(causes)}
        code = {line: code_of(source.line(line)).strip() for line in each(causes)}
        self._lost_default = bool(self._like("DEFAULT")) or any(
            text[:1] in _WITHOUT_HEAD for text in each(code.values()) if text
        )
        self._lost_cell = bool(self._like("CELL")) or any(".TOML" in text.upper() for text in code.values())
        self._lost_head = min((line for head in BLOCK_HEADS for line in self._like(head)), default=math.inf)
        self._lost_end = any(
            self._firsts[line] not in BLOCK_ENDS for end in BLOCK_ENDS for line in self._like(end)
        )
        self._doubtful = _doubtful(source, words)
        self._first_said: dict[str, int] = {}
        for line, said in each(sorted(words.items())):
            for word in said:
                self._first_said.setdefault(word, line)

    def explain(self, finding: Diagnostic) -> bool:
        """Return True if a finding follows from another finding."""
        line = _line(finding, self._source)
        if any(self._leads(cause, line) for cause in everything()[finding.code].follows):
            return True
        match _need(finding):
            case "place":
                return _rests_on(finding, line, self._source, self._doubtful)
            case "end":
                return self._lost_end
            case "block":
                return self._lost_head < line
            case "default":
                return self._lost_default and not _is_like(self._firsts.get(line, ""), "DEFAULT")
            case "use":
                return self._lost_name or self._is_spoken_of(finding)
            case "name" | "meaning":
                return self._lost(finding, line)
        return False

    def _is_spoken_of(self, finding: Diagnostic) -> bool:
        """Return True if the name that a finding is about also occurs in another line with an error."""
        if (
            finding.span is None
            or finding.source is not self._source
            or finding.span.line != finding.span.end_line
        ):
            return False
        said = self._source.line(finding.span.line)[finding.span.column - 1 : finding.span.end_column - 1]
        return any(
            said.strip("{} ").upper() in _words(self._source.line(line))
            for line in each(self._wrong - {finding.span.line})
        )

    def _like(self, word: str) -> list[int]:
        """Return the lines with errors whose first word is `word` or similar to it."""
        return [line for line, first in each(self._firsts.items()) if _is_like(first, word)]

    def _leads(self, cause: Follows, line: int) -> bool:
        """Return True if a finding in line `line` follows from a finding with the code of `cause`.
        `cause.where` states whether the cause must be in the same line, above it or anywhere.
        """
        lines = self._lines.get(cause.code, ())
        match cause.where:
            case "here":
                return line in lines
            case "above":
                return self._above.get(cause.code, math.inf) < line
            case "elsewhere":
                return bool(lines) and line not in self._causes

    def _lost(self, finding: Diagnostic, line: int) -> bool:
        """Return True if the unknown name that a finding reports may be declared in an earlier line with an
        error, or in a cell or module that can't be read.
        """
        if self._lost_cell and line not in self._lines.get(_MISPLACED, ()):
            return self._firsts.get(line, "") != "CELL"
        name = finding.subject.name if isinstance(finding.subject, Name) else ""
        told = min(self._first_said.get(word, math.inf) for word in (name, name.partition(".")[0]))
        return told < (line or math.inf) or ("." in name and self._lost_module)


def _doubtful(source: SourceFile, words: dict[int, set[str]]) -> frozenset[str]:
    """Return the names whose declarations have errors or use such names. `DEFAULT` is included if the DEFAULT
    line has an error or uses such a name.
    """
    lost: set[str] = set()
    heads = {*_GIVES_NAMES, "DEFAULT"}
    if not any(_first(source.line(line)) in heads for line in words):
        return frozenset()
    for number, line in each(enumerate(source.lines, 1)):
        said = _WORD.findall(code_of(line).upper())
        if not said or said[0] not in heads:
            continue
        if number in words or lost & set(said[1:]):
            lost |= {said[0]} & {"DEFAULT"} | set(said[1:2] if said[0] in _GIVES_NAMES else ())
    return frozenset(lost)


def _rests_on(finding: Diagnostic, line: int, source: SourceFile, doubtful: frozenset[str]) -> bool:
    """Return True if a finding about a motion may come from names whose declarations have errors.

    If there are such names, this is assumed for every finding in a loop or SUB; if DEFAULT is one of the
    names, for every finding.
    """
    if not doubtful:
        return False
    words = _WORD.findall(code_of(source.line(line)).upper()) if line else []
    # Leave out the name that the line itself declares: it is doubtful because of this very line.
    said = set(words[:1] + words[2:] if words[:1] and words[0] in _GIVES_NAMES else words)
    return bool(finding.place) or "DEFAULT" in doubtful or bool(said & doubtful)


def _need(finding: Diagnostic) -> Need:
    return everything()[finding.code].need


def _line(finding: Diagnostic, source: SourceFile) -> int:
    """Return the line of a finding in the program's file; 0 if the finding has no line, or is in another
    file.
    """
    is_own = finding.span is not None and finding.source is not None and finding.source.name == source.name
    return finding.span.line if finding.span is not None and is_own else 0


def _declares(source: SourceFile, line: int) -> bool:
    return _first(source.line(line)) in DECLARATIONS


def _first(line: str) -> str:
    """Return a line's first word in upper case."""
    found = _WORD.search(code_of(line))
    return found[0].upper() if found else ""


def _words(line: str) -> set[str]:
    return {word.upper() for word in _WORD.findall(code_of(line))} - DECLARATIONS


@lru_cache(maxsize=1 << 12)
def _is_like(word: str, known_name: str) -> bool:
    if word == known_name:
        return True
    # This is an upper bound of difflib's ratio, computed in a hundredth of the time.
    common = sum(letter in known_name for letter in word)
    if 2.0 * common < _LIKE * (len(word) + len(known_name)):
        return False
    return bool(get_close_matches(word, [known_name], n=1, cutoff=_LIKE))


def _said_once(findings: list[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Merge findings that repeat each other: those about the same unknown name, and many similar ones.

    The first finding of each group stays, and its message gets the number of the other findings.
    """
    groups = gathered(findings, lambda one: _repeated(one) or one)
    return tuple(one for group in each(groups) for one in _shortened(group))


def _repeated(finding: Diagnostic) -> tuple[str, object] | None:
    """Return a key that is equal for findings that repeat each other: the unknown name, or the finding's
    code.

    Returns:
        None for a finding that is never merged with others.
    """
    need = _need(finding)
    if need == "name" and isinstance(finding.subject, Name) and finding.subject.name:
        return "name", finding.subject.name
    return ("alike", finding.code) if need in _BY_DEFAULT else None


def _shortened(group: list[Diagnostic]) -> list[Diagnostic]:
    """Return only the first of several findings that repeat each other, with the number of the other findings
    in its message. If the findings are few, or are never merged, return all of them.
    """
    first = group[0]
    kind, _ = _repeated(first) or ("", None)
    in_lines = {one.span.line for one in each(group) if one.span is not None}
    if not kind or len(group) < 2 or (kind == "alike" and len(in_lines) < _MANY):
        return group
    more = len(group) - 1
    lines = f"{more} more line{'s' * (more != 1)}"
    # Findings about another name, or at another place of unrolled code, are similar, but not the same.
    here = (first.subject, first.place)
    is_like_it = here[0] is not None and any((one.subject, one.place) != here for one in each(group))
    again = f"{more} more like it" if kind == "alike" and is_like_it else f"the same in {lines}"
    return [replace(first, message=f"{first.message}; {again}")]


def few_in_a_line(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Of the findings with the same code in a line, keep only the first ones. The message of the last finding
    that is kept gets the number of the dropped findings.
    """
    groups = gathered(diagnostics, _line_and_code)
    return tuple(one for group in each(groups) for one in _few(group))


def _few(group: list[Diagnostic]) -> list[Diagnostic]:
    """Return the first findings with one code in one line. Findings without a line are all returned."""
    more = len(group) - _MOST_IN_A_LINE
    if group[0].span is None or more <= 0:
        return group
    *first, last = group[:_MOST_IN_A_LINE]
    return [*first, replace(last, message=f"{last.message}; {more:,} more like it in this line")]


def _line_and_code(finding: Diagnostic) -> tuple[str, int, str]:
    """Return the file, line and code of a finding; line 0 if it has no place."""
    return (
        finding.source.name if finding.source else "",
        finding.span.line if finding.span else 0,
        finding.code,
    )
