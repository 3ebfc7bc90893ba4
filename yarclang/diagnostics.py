"""What every stage says about the user's input: findings, collected, never raised."""

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
    """Replace the text of a span."""

    span: Span
    text: str


@frozen
class Fix:
    """A change of the source that removes the finding."""

    title: str
    edits: tuple[Edit, ...]
    by_choice: bool = False
    """Whether it repairs nothing, but says the same in another way: it is made only where somebody asks for just this one."""
    uncovers: bool = False
    """True if the text could not be read before the fix: errors of its meaning that appear afterwards were there, and nobody saw them."""


@frozen
class Within:
    """Where in a module a finding was made that is shown at the line that called the module.

    `through` are the SUBs between that line's and the place, from outside in, as `APPROACH.IN`. `fix` is a change of the module's text; None for an installed
    module, which nobody edits.
    """

    source: SourceFile
    span: Span
    through: tuple[str, ...] = ()
    fix: Fix | None = None

    @property
    def text(self) -> str:
        """The place in words: `in APPROACH, line 14 (through APPROACH.IN): P0010 MOVEL ...`."""
        through = f" (through {', '.join(self.through)})" if self.through else ""
        line = " ".join(self.source.line(self.span.line).split())
        return f"in {self.source.called}, line {self.span.line}{through}: {line}"


_LONGEST_QUOTE, _SHOWN = 300, 60
_TOO_LONG = re.compile(rf"\S{{{_LONGEST_QUOTE + 1},}}")


@frozen
class Diagnostic:
    """One finding: a code of the catalogue, one sentence with its figures, and where.

    `message` and `help` are for people; a program that needs a fact of them takes it from `subject`. `source` and `span` are None where the finding has no
    place in a text.
    """

    code: str
    message: str
    source: SourceFile | None = None
    span: Span | None = None
    help: str = ""
    fix: Fix | None = None
    place: str = ""
    """Of a finding in unrolled code: what led to the command, as `P0020(I=2)>P0010`."""
    level: Severity | None = None
    """Of a rule's finding, or one whose severity a project has set: that severity."""
    within: Within | None = None
    """Where in a module the cause is, of a finding that is shown at the line that called the module."""
    subject: Subject | None = None
    """What the finding is about, if somebody acts on it."""

    def __post_init__(self) -> None:
        """Keep sentences readable whatever they quote: of what is too long to be a word the beginning is enough."""
        for name in ("message", "help"):
            text = getattr(self, name)
            if len(text) > _LONGEST_QUOTE:
                object.__setattr__(self, name, _TOO_LONG.sub(lambda found: found[0][:_SHOWN] + "…", text))

    @property
    def shown_at(self) -> Span | None:
        """The span within its lines: of what is missing at the end of a line, the line's last character."""
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
        """The message as a part of a longer sentence: without a full stop."""
        return self.message.rstrip(".")

    @property
    def family(self) -> str:
        """The two digits of the code's family."""
        return family_of(self.code)

    @property
    def made_at(self) -> tuple[SourceFile | None, Span | None]:
        """Where the finding was made: in a module, or at its own place."""
        return (self.source, self.span) if self.within is None else (self.within.source, self.within.span)

    @property
    def severity(self) -> Severity:
        """How severe it is: as it was set, else as the catalogue says of its code."""
        return self.level or CATALOGUE[self.code].severity

    @property
    def is_error(self) -> bool:
        """Whether this finding stops the output."""
        return self.severity == "error"


@frozen
class Result(Generic[T]):
    """The answer of a stage: its product, or None where an error forbids one, and the findings."""

    value: T | None
    diagnostics: tuple[Diagnostic, ...] = field(default=())

    @property
    def ok(self) -> bool:
        """Whether there is a product and no error."""
        return self.value is not None and not has_errors(self.diagnostics)


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether one of the findings is an error."""
    return any(diagnostic.is_error for diagnostic in diagnostics)


def in_order(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The findings sorted by file and place, each said once."""
    once = list(dict.fromkeys(each(diagnostics)))
    # tuples are compared in a tenth of the time that spans take
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
    """Return a place without the rounds of its loops: `P0020(I=2)>P0010` is in `P0020>P0010`."""
    return _ROUNDS.sub("", place)


def grouped(diagnostics: Iterable[Diagnostic], *, at_least: bool = False) -> tuple[Diagnostic, ...]:
    """One finding for all that say the same code at the same span: the first, with its place and how many more there are.

    `at_least` is True if not all was looked at, so that there may be more.
    """
    return tuple(_first(found, at_least) for found in each(gathered(diagnostics, _repeated)))


def gathered(
    diagnostics: Iterable[Diagnostic], key: Callable[[Diagnostic], Hashable]
) -> list[list[Diagnostic]]:
    """Return findings in groups with equal keys, in the order of the first of each."""
    groups: dict[Hashable, list[Diagnostic]] = {}
    for one in each(diagnostics):
        groups.setdefault(key(one), []).append(one)
    return list(groups.values())


def _repeated(one: Diagnostic) -> Hashable:
    """Return what a finding has in common with those that only repeat it."""
    name = one.source.name if one.source else ""
    if not one.place:  # nothing was unrolled: two findings are two
        return one.code, name, one.span, "", one.message
    # each call of a module is shown by itself
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
    """A finding that is raised where its place isn't known.

    Args:
        code: of the catalogue.
        message: its sentence.
        help_: what to do.
        subject: what it is about.
    """

    def __init__(self, code: str, message: str, help_: str = "", subject: Subject | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.help = help_
        self.subject = subject


class Collector:
    """Collects the findings of one source while a stage goes on; `place` is where in unrolled code it is."""

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
        """Add a finding that was raised, at its place."""
        self.add(error.code, error.message, span, error.help, subject=error.subject)

    @property
    def has_errors(self) -> bool:
        """Whether an error was added."""
        return has_errors(self.found)
