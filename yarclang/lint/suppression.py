"""Comments that suppress findings: `! yarc: ignore[Y0505]`, at the end of a line or alone above it."""

from __future__ import annotations

import re
from collections.abc import Iterable

from yarclang.diagnostics import Diagnostic, Edit, Fix, suggest
from yarclang.frozen import frozen
from yarclang.lint.registry import codes_of, everything
from yarclang.source import SourceFile, Span
from yarclang.syntax.lines import code_of

_COMMENT = re.compile(r"!\s*yarc\s*:\s*ignore\b\s*(\[[^\]]*\]?)?", re.IGNORECASE)
_WORD = re.compile(r"[^\s,\[\]]+")


@frozen
class Suppression:
    """One code in a comment: for which line, where it stands, and how it is taken away."""

    code: str
    line: int
    span: Span
    fix: Fix


def suppress(
    source: SourceFile, diagnostics: Iterable[Diagnostic], *, is_whole: bool = True
) -> tuple[Diagnostic, ...]:
    """The findings without those that the source's comments suppress, and a finding for each comment that suppresses nothing.

    Args:
        source: the file whose comments are read.
        diagnostics: all findings; those of other files, and errors, stay.
        is_whole: whether all was looked for; if not, a comment that suppresses nothing may be right.
    """
    found = tuple(diagnostics)
    if _COMMENT.search(source.text) is None:
        return found
    said, suppressions = _read(source)
    used: set[Suppression] = set()
    kept: list[Diagnostic] = []
    for one in found:
        by = [] if one.is_error else [each for each in suppressions if _speaks_of(each, one, source)]
        used.update(by)
        if not by:
            kept.append(one)
    for each in suppressions:
        if is_whole and each not in used:
            message = f"line {each.line} has no finding {each.code}: the comment suppresses nothing"
            said.append(Diagnostic("Y1701", message, source, each.span, "take it away", each.fix))
    return (*kept, *said)


def _speaks_of(one: Suppression, finding: Diagnostic, source: SourceFile) -> bool:
    span = finding.span
    if finding.source is None or span is None or finding.source.name != source.name:
        return False
    return finding.code == one.code and span.line <= one.line <= max(span.line, span.end_line)


def _read(source: SourceFile) -> tuple[list[Diagnostic], list[Suppression]]:
    said: list[Diagnostic] = []
    read: list[Suppression] = []
    for number, line in enumerate(source.lines, 1):
        begin = len(code_of(line))
        if (found := _COMMENT.search(line, begin)) is None:
            continue
        target = number if line[:begin].strip() else _next_line(source, number)
        whole = Span.on_line(number, found.start() + 1, found.end() + 1)
        words = list(_WORD.finditer(line, found.start(1), found.end(1))) if found[1] else []
        if not words or not found[1].endswith("]"):
            help_ = "write ! yarc: ignore[Y0505], with the codes of the findings"
            said.append(
                Diagnostic("Y1702", "this comment doesn't say what it suppresses", source, whole, help_)
            )
            continue
        fix = _without(source, number, found)
        for word in words:
            span = Span.on_line(number, word.start() + 1, word.end() + 1)
            one = _suppression(word[0], target, span, fix if len(words) == 1 else _fewer(number, words, word))
            if isinstance(one, Suppression):
                read.append(one)
            else:
                said.append(Diagnostic("Y1702", one[0], source, span, one[1]))
    return said, read


def _suppression(word: str, line: int, span: Span, fix: Fix) -> Suppression | tuple[str, str]:
    """A code or name; else what is wrong with it, and what to do."""
    codes = codes_of(word) if not re.fullmatch(r"[Yy]\d{0,3}", word) else ()
    if not codes:
        return f"no finding is called {word}", suggest(word, everything()) or "yarc explain lists all codes"
    code = codes[0]
    if everything()[code].severity == "error":
        return f"{code} is an error, and errors can't be suppressed", "yarc explain says what to do about it"
    return Suppression(code, line, span, fix)


def _next_line(source: SourceFile, number: int) -> int:
    """The next line that is more than a comment."""
    for following in range(number + 1, len(source.lines) + 1):
        if code_of(source.line(following)).strip():
            return following
    return number


def _without(source: SourceFile, number: int, found: re.Match[str]) -> Fix:
    """The whole comment away; a line that has nothing else goes with it."""
    line = source.line(number)
    rest = line[found.end() :].strip()
    if rest:  # words of the comment that are for people stay
        span = Span.on_line(number, found.start() + 1, len(line) + 1)
        return Fix("take the suppression away", (Edit(span, f"! {rest.lstrip('!').lstrip()}"),))
    begin = len(line[: found.start()].rstrip())
    if not line[:begin].strip():
        return Fix("take the comment away", (Edit(Span(number, 1, number + 1, 1), ""),))
    return Fix("take the comment away", (Edit(Span.on_line(number, begin + 1, len(line) + 1), ""),))


def _fewer(number: int, words: list[re.Match[str]], word: re.Match[str]) -> Fix:
    """One code away, and a comma beside it."""
    at = words.index(word)
    begin, end = (
        (word.start(), words[at + 1].start()) if at + 1 < len(words) else (words[at - 1].end(), word.end())
    )
    return Fix(f"take {word[0]} away", (Edit(Span.on_line(number, begin + 1, end + 1), ""),))
