"""Comments that suppress findings: `! yarc: ignore[Y0505]`, at the end of a line or on a separate line above
it.

A finding in a module that is shown at a CALL can be suppressed by a comment at the CALL, for this line only,
or by a comment in the module, for all programs.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping

from yarclang import subjects
from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.frozen import frozen
from yarclang.lint.registry import codes_of, everything
from yarclang.progress import each
from yarclang.source import SourceFile, Span
from yarclang.subjects import Name
from yarclang.syntax.lines import code_of

_COMMENT = re.compile(r"!\s*yarc\s*:\s*ignore\b\s*(\[[^\]]*\]?)?", re.IGNORECASE)
_WORD = re.compile(r"[^\s,\[\]]+")

_BEGINNING = re.compile(r"[Yy]\d{0,3}")

_MOST_HELPED = 20
"""Largest number of wrong words in one comment for which the finding has a help. Each further wrong word gets
a finding without help, because no more findings on one line are shown.
"""


@frozen
class Suppression:
    """The code of one finding in a comment that suppresses findings.

    Attributes:
        code: the code.
        line: the line whose findings it suppresses.
        span: place of the code.
        fix: edit that removes the code.
    """

    code: str
    line: int
    span: Span
    fix: Fix


def has_suppressions(source: SourceFile) -> bool:
    """Return True if a file has comments that suppress findings."""
    return _COMMENT.search(source.text) is not None


def suppress(
    source: SourceFile,
    diagnostics: Iterable[Diagnostic],
    *,
    is_whole: bool = True,
    unjudged: Collection[int] = (),
) -> tuple[Diagnostic, ...]:
    """Remove the findings that comments suppress, and add a finding for each comment that suppresses nothing.

    Args:
        source: the file whose comments are read, besides those of modules with findings.
        diagnostics: all findings. Errors can't be suppressed.
        is_whole: True if all checks were made. Otherwise a comment that suppresses nothing gets no finding,
            because a later check may need it.
        unjudged: lines in which such a comment gets no finding either: those of SUBs that only other files
            call.
    """
    found = _without_those_of_modules(source, tuple(diagnostics))
    if not has_suppressions(source):
        return found
    said, suppressions = _read(source)
    by_line: dict[tuple[str, int], list[Suppression]] = {}
    for suppression in each(suppressions):
        by_line.setdefault((suppression.code, suppression.line), []).append(suppression)
    used: set[Suppression] = set()
    kept: list[Diagnostic] = []
    for finding in each(found):
        by = [] if finding.is_error else _speaking_of(finding, source, by_line)
        used.update(by)
        if not by:
            kept.append(finding)
    for suppression in each(suppressions) if is_whole else ():
        if suppression not in used and suppression.line not in unjudged:
            message = f"the comment has no effect: line {suppression.line} has no finding {suppression.code}"
            said.append(Diagnostic("Y1701", message, source, suppression.span, "remove it", suppression.fix))
    return (*kept, *said)


def _without_those_of_modules(source: SourceFile, found: tuple[Diagnostic, ...]) -> tuple[Diagnostic, ...]:
    """Return the findings without those that are in a module and that a comment in the module suppresses."""
    read: dict[str, set[tuple[str, int]]] = {}

    def is_suppressed(one: Diagnostic) -> bool:
        there, span = one.made_at
        if one.is_error or there is None or span is None or there.name == source.name:
            return False
        if there.name not in read:
            spoken = _read(there)[1] if _COMMENT.search(there.text) else []
            read[there.name] = {(by.code, by.line) for by in spoken}
        return any((one.code, line) in read[there.name] for line in range(span.line, span.end_line + 1))

    return tuple(one for one in each(found) if not is_suppressed(one))


def _speaking_of(
    finding: Diagnostic, source: SourceFile, by_line: Mapping[tuple[str, int], list[Suppression]]
) -> list[Suppression]:
    """Return the suppressions of a finding's code in the lines of the finding."""
    span = finding.span
    if finding.source is None or span is None or finding.source.name != source.name:
        return []
    lines = range(span.line, max(span.line, span.end_line) + 1)
    return [one for line in lines for one in by_line.get((finding.code, line), ())]


def _read(source: SourceFile) -> tuple[list[Diagnostic], list[Suppression]]:
    said: list[Diagnostic] = []
    read: list[Suppression] = []
    following: list[int] = []
    for number, line in each(enumerate(source.lines, 1)):
        begin = len(code_of(line))
        if (match := _COMMENT.search(line, begin)) is None:
            continue
        if line[:begin].strip():
            target = number
        else:
            following = following or _next_lines(source)
            target = following[number - 1] or number
        whole = Span.on_line(number, match.start() + 1, match.end() + 1)
        words = list(_WORD.finditer(line, match.start(1), match.end(1))) if match[1] else []
        if not words or not match[1].endswith("]"):
            help_ = "write ! yarc: ignore[Y0505], with the codes of the findings"
            said.append(
                Diagnostic("Y1702", "this comment names no finding to suppress", source, whole, help_)
            )
            continue
        whole_fix = _without(source, number, match)
        unknown = 0
        for at, word in each(enumerate(words)):
            span = Span.on_line(number, word.start() + 1, word.end() + 1)
            code, wrong = _code(word[0])
            if code:
                fix = whole_fix if len(words) == 1 else _fewer(number, words, at)
                read.append(Suppression(code, target, span, fix))
                continue
            unknown += 1
            help_, subject = _help(word[0]) if unknown <= _MOST_HELPED else ("", None)
            said.append(Diagnostic("Y1702", wrong, source, span, help_, subject=subject))
    return said, read


def _code(word: str) -> tuple[str, str]:
    """Return the code of the finding that a word in a comment selects, and an empty text. If the word selects
    none that can be suppressed, return an empty text and the error message.
    """
    codes = _codes(word)
    if not codes:
        return "", f"there is no finding {word}"
    if everything()[codes[0]].severity == "error":
        return "", f"{codes[0]} is an error, and errors can't be suppressed"
    return codes[0], ""


def _help(word: str) -> tuple[str, Name | None]:
    """Return the help about a wrong word in a suppressing comment, and the word itself if no finding has this
    name or code.
    """
    if _codes(word):
        return f"`yarc explain {_codes(word)[0]}` gives the remedy", None
    subject = subjects.unknown(word, everything())
    return subject.question or "`yarc explain` lists all codes", subject


def _codes(word: str) -> tuple[str, ...]:
    """Return the codes of the findings that a word in a comment selects; empty if the word is only the
    beginning of codes.
    """
    return () if _BEGINNING.fullmatch(word) else codes_of(word)


def _next_lines(source: SourceFile) -> list[int]:
    """Return for each line (from 1) the number of the next line with code; 0 if there is none."""
    found, following = [0], 0
    for number in each(range(len(source.lines), 0, -1)):
        found.append(following)
        if code_of(source.line(number)).strip():
            following = number
    return found[::-1]


def _without(source: SourceFile, number: int, found: re.Match[str]) -> Fix:
    """Return the fix that removes a whole suppressing comment, and its line if the line is empty then.

    Args:
        source: the file.
        number: number of the line, from 1.
        found: the suppression in the line.
    """
    line = source.line(number)
    rest = line[found.end() :].strip()
    if rest:  # keep the rest of the comment, which is for people
        span = Span.on_line(number, found.start() + 1, len(line) + 1)
        return Fix("remove the suppression", (Edit(span, f"! {rest.lstrip('!').lstrip()}"),))
    begin = len(line[: found.start()].rstrip())
    if not line[:begin].strip():
        return Fix("remove the comment", (Edit(Span(number, 1, number + 1, 1), ""),))
    return Fix("remove the comment", (Edit(Span.on_line(number, begin + 1, len(line) + 1), ""),))


def _fewer(number: int, words: list[re.Match[str]], at: int) -> Fix:
    """Return the fix that removes one code from a suppressing comment, and the comma beside it.

    Args:
        number: number of the line, from 1.
        words: the codes in the comment.
        at: number of the code in `words`.
    """
    word = words[at]
    begin, end = (
        (word.start(), words[at + 1].start()) if at + 1 < len(words) else (words[at - 1].end(), word.end())
    )
    return Fix(f"remove {word[0]}", (Edit(Span.on_line(number, begin + 1, end + 1), ""),))
