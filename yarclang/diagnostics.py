"""Findings: the errors, warnings and notes that a stage of the compiler reports about the user's input. They
are collected, never raised.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable
from dataclasses import field, replace
from typing import Generic, TypeVar

from yarclang.findings import CATALOGUE, Severity, family_of
from yarclang.frozen import frozen
from yarclang.progress import each, go_on
from yarclang.source import SourceFile, Span
from yarclang.subjects import Subject

T = TypeVar("T")


@frozen
class Edit:
    """A replacement for the text of a span."""

    span: Span
    text: str


@frozen
class Fix:
    """A change of the source that removes the finding.

    Attributes:
        title: description of the change.
        edits: the edits of the change.
        by_choice: True for rewrites that fix no error. Applied only when selected explicitly.
        uncovers: True if the text couldn't be parsed before the fix. New errors after the fix are then
            allowed, since they were only hidden before.
    """

    title: str
    edits: tuple[Edit, ...]
    by_choice: bool = False
    uncovers: bool = False


@frozen
class Within:
    """The place in a module that causes a finding, if the finding is shown at the program line that called
    the module.

    Attributes:
        source: the module.
        span: the place in the module.
        through: further SUBs that are called between the program line and the place, in order, such as
            `APPROACH.IN`.
        fix: change of the module's text; None for an installed module, which nobody edits.
    """

    source: SourceFile
    span: Span
    through: tuple[str, ...] = ()
    fix: Fix | None = None

    @property
    def text(self) -> str:
        """Return the place in words: `in APPROACH, line 14 (through APPROACH.IN): P0010 MOVEL ...`."""
        through = f" (through {', '.join(self.through)})" if self.through else ""
        line = " ".join(self.source.line(self.span.line).split())
        return f"in {self.source.called}, line {self.span.line}{through}: {line}"


_LONGEST_QUOTE, _SHOWN = 300, 60
_TOO_LONG = re.compile(rf"\S{{{_LONGEST_QUOTE + 1},}}")


@frozen
class Diagnostic:
    """An error, a warning or a note about the user's input.

    Attributes:
        code: code in the catalogue of findings.
        message: one sentence with its numbers, for people. Programs use `subject`.
        source: the text that the finding is about; None if the finding has no place.
        span: the place in the text; None if the finding has none.
        help: remedy, for people.
        fix: a change that removes the finding; None without one.
        place: in unrolled code, the commands that led to this one, such as `P0020(I=2)>P0010`.
        level: severity that a lint rule or the project has set; None for the severity in the catalogue.
        within: place of the cause in a module, if the finding is shown at the line that called the module.
        subject: the finding's facts for programs that act on it; None without them.
    """

    code: str
    message: str
    source: SourceFile | None = None
    span: Span | None = None
    help: str = ""
    fix: Fix | None = None
    place: str = ""
    level: Severity | None = None
    within: Within | None = None
    subject: Subject | None = None

    def __post_init__(self) -> None:
        """Shorten quoted words that are too long to read."""
        for name in ("message", "help"):
            text = getattr(self, name)
            if len(text) > _LONGEST_QUOTE:
                object.__setattr__(self, name, _TOO_LONG.sub(lambda found: found[0][:_SHOWN] + "…", text))

    @property
    def shown_at(self) -> Span | None:
        """Return the range of the text to mark for the finding, within the lines of the text.

        If something is missing at the end of a line, the range is the line's last character.
        """
        span = self.span
        if span is None or self.source is None or len(self.source.lines) < span.end_line:
            return span
        first, last = len(self.source.line(span.line)), len(self.source.line(span.end_line))
        column = min(span.column, max(first, 1))
        end = min(span.end_column, last + 1)
        if span.line == span.end_line:
            end = max(end, column + 1)
        return Span(span.line, column, span.end_line, end)

    @property
    def clause(self) -> str:
        """Return the message without a full stop, as a part of a longer sentence."""
        return self.message.rstrip(".")

    @property
    def family(self) -> str:
        """Return the two digits of the code's family."""
        return family_of(self.code)

    @property
    def made_at(self) -> tuple[SourceFile | None, Span | None]:
        """Return the place of the cause: the place in a module if the finding has one, otherwise its own
        place.
        """
        return (self.source, self.span) if self.within is None else (self.within.source, self.within.span)

    @property
    def severity(self) -> Severity:
        """Return the severity that was set, otherwise that of the code in the catalogue."""
        return self.level or CATALOGUE[self.code].severity

    @property
    def is_error(self) -> bool:
        """Return True if this finding is an error, which prevents the stage's result."""
        return self.severity == "error"


@frozen
class Result(Generic[T]):
    """The result of a stage of the compiler.

    Attributes:
        value: what the stage produces, such as a plan; None if an error prevents it.
        diagnostics: the findings.
    """

    value: T | None
    diagnostics: tuple[Diagnostic, ...] = field(default=())

    @property
    def ok(self) -> bool:
        """Return True if there is a value and no error."""
        return self.value is not None and not has_errors(self.diagnostics)


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Return True if one of the findings is an error."""
    return any(diagnostic.is_error for diagnostic in diagnostics)


def in_order(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return the findings without repetitions, sorted by file and place."""
    once = list(dict.fromkeys(each(diagnostics)))
    # comparing tuples takes a tenth of the time of comparing spans
    keys = [_order(one) for one in each(once)]
    go_on()
    return tuple(once[at] for at in sorted(range(len(once)), key=keys.__getitem__))


def _order(one: Diagnostic) -> tuple[str, int, int, int, int, str]:
    name = one.source.name if one.source else ""
    span = one.span
    if span is None:
        return name, 0, 0, 0, 0, one.code
    return name, span.line, span.column, span.end_line, span.end_column, one.code


_ROUNDS = re.compile(r"\([^()]*\)")


def static_place(place: str) -> str:
    """Return the place of a command without the numbers of its loop passes, such as `P0020>P0010` for
    `P0020(I=2)>P0010`.
    """
    return _ROUNDS.sub("", place)


def grouped(diagnostics: Iterable[Diagnostic], *, at_least: bool = False) -> tuple[Diagnostic, ...]:
    """Merge findings with the same code and span to one: the first one, with the number of the others in its
    message.

    Args:
        diagnostics: the findings.
        at_least: True if not everything was checked, so that there may be more.
    """
    return tuple(_first(found, at_least) for found in each(gathered(diagnostics, _repeated)))


def gathered(
    diagnostics: Iterable[Diagnostic], key: Callable[[Diagnostic], Hashable]
) -> list[list[Diagnostic]]:
    """Group findings by equal keys. The groups are in the order of their first findings."""
    groups: dict[Hashable, list[Diagnostic]] = {}
    for one in each(diagnostics):
        groups.setdefault(key(one), []).append(one)
    return list(groups.values())


def _repeated(one: Diagnostic) -> Hashable:
    """Return a key that is equal for findings that only repeat each other."""
    name = one.source.name if one.source else ""
    if not one.place:  # nothing was unrolled: each finding counts
        return one.code, name, one.span, "", one.message
    # Each call of a module is shown separately.
    calls = static_place(one.place) if one.source and one.source.module else ""
    return one.code, name, one.span, calls


def _first(found: list[Diagnostic], at_least: bool) -> Diagnostic:
    first = found[0]
    if not first.place:
        return first
    more = len(found) - 1
    least = "at least " if at_least else ""
    again = f", and {least}{more:,} more time{'s' * (more != 1)}" if more else ""
    return replace(first, message=f"{first.message} (at {first.place}{again})")


class FindingError(ValueError):
    """A finding that is raised as an exception by code that doesn't know the finding's place.

    Args:
        code: code in the catalogue of findings.
        message: message for people.
        help_: remedy for people.
        subject: facts for programs.
    """

    def __init__(self, code: str, message: str, help_: str = "", subject: Subject | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.help = help_
        self.subject = subject


class Collector:
    """Collector of a stage's findings about one source file; `place` is the current place in unrolled
    code.
    """

    def __init__(self, source: SourceFile) -> None:
        self.source = source
        self.found: list[Diagnostic] = []
        self.place = ""

    def add(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        help_: str = "",
        fix: Fix | None = None,
        subject: Subject | None = None,
    ) -> None:
        """Add one finding."""
        made = Diagnostic(code, message, self.source, span, help_, fix, self.place, subject=subject)
        self.found.append(made)

    def add_error(self, error: FindingError, span: Span | None) -> None:
        """Add a raised finding at its place."""
        self.add(error.code, error.message, span, error.help, subject=error.subject)

    @property
    def has_errors(self) -> bool:
        """Return True if an error was added."""
        return has_errors(self.found)
