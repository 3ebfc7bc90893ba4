"""What every stage says about the user's input: findings, collected, never raised."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import field, replace
from functools import lru_cache
from typing import Generic, TypeVar

from yarclang.findings import CATALOGUE, Severity
from yarclang.frozen import frozen
from yarclang.progress import each, go_on
from yarclang.source import SourceFile, Span

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

    `source` and `span` are None where the finding has no place in a text.
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

    def __post_init__(self) -> None:
        """Keep sentences readable whatever they quote: of what is too long to be a word the beginning is enough."""
        for name in ("message", "help"):
            text = getattr(self, name)
            if len(text) > _LONGEST_QUOTE:
                object.__setattr__(self, name, _TOO_LONG.sub(lambda found: found[0][:_SHOWN] + "…", text))

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
    groups: dict[tuple[str, str, Span | None], list[Diagnostic]] = {}
    for one in each(diagnostics):
        # without a place nothing was unrolled: two findings are two
        name = one.source.name if one.source else ""
        key = (one.code, name, one.span) if one.place else (one.code + one.message, name, one.span)
        if (
            one.place and one.source is not None and one.source.module
        ):  # each call of a module is shown by itself
            key = (one.code + static_place(one.place), name, one.span)
        groups.setdefault(key, []).append(one)
    return tuple(_first(found, at_least) for found in each(groups.values()))


def _first(found: list[Diagnostic], at_least: bool) -> Diagnostic:
    first = found[0]
    if not first.place:
        return first
    more = len(found) - 1
    least = "at least " if at_least else ""
    again = f", and {least}{more:,} more time{'s' * (more != 1)}" if more else ""
    return replace(first, message=f"{first.message} (at {first.place}{again})")


_LONGEST_NAME = 200
"""Characters; nobody means a name by a longer word."""


def suggest(word: str, known: Iterable[str]) -> str:
    """`did you mean X?` for a mistyped word, or nothing where no known one is near."""
    return _suggestion(word.upper(), tuple(known))


_NEAR = 0.6
"""How like a mistyped word what was meant is at least: difflib's ratio."""

_MOST_LIKELY = 12
"""Names of which the longest common subsequence with a mistyped word is found: those that may be the nearest by their letters."""

_MOST_COMPARED, _COMPARED_LETTERS = 5, 150
"""Names that difflib compares with a mistyped word, and their letters in all: one comparison takes the square of the letters."""


@lru_cache(maxsize=256)
def _suggestion(word: str, known: tuple[str, ...]) -> str:
    from difflib import get_close_matches

    if len(word) > _LONGEST_NAME:
        return ""
    names, letters = _described(known)
    near = get_close_matches(word, _likely(word, names, letters), n=5, cutoff=_NEAR)
    if not near:
        return ""
    # of equally near names, the one with the same letters in another order was meant
    near.sort(key=lambda name: sorted(name) != sorted(word))
    return f"did you mean {names[near[0]]}?"


@lru_cache(maxsize=8)
def _described(known: tuple[str, ...]) -> tuple[dict[str, str], tuple[int, ...]]:
    """Return names by themselves in upper case, and the letters of each."""
    names = dict(zip(map(str.upper, known), known, strict=True))
    return names, tuple(map(_letters, names))


def _likely(word: str, names: Iterable[str], letters: Iterable[int]) -> list[str]:
    """Return the few names that may be nearest to a word.

    Two upper bounds of difflib's ratio tell which: one by lengths and letters, and of the best by that, one by the longest common subsequence. They take a
    hundredth and a tenth of difflib's time.

    Args:
        word: what was typed.
        names: what it may mean.
        letters: the letters of each name.
    """
    from heapq import nlargest

    mine, length, begin = _letters(word), len(word), word[: len(word) // 2]
    # 2 common >= near (length + other), and other >= common: so many of the word's letters are in the name, each counted once
    fewest = mine.bit_count() - length + _NEAR / (2.0 - _NEAR) * length
    pairs = [
        (name, theirs)
        for name, theirs in zip(names, letters, strict=True)
        if (mine & theirs).bit_count() >= fewest
    ]
    found = []
    for name, theirs in pairs:
        other = len(name)
        both = length + other
        least = _NEAR / 2.0 * both
        common = length - (mine & ~theirs).bit_count()
        if common >= least and (rest := other - (theirs & ~mine).bit_count()) >= least:
            found.append((min(common, rest) / both, name.startswith(begin), name))
    most = max(_MOST_LIKELY, length // 2)  # of long words, letters tell little
    if len(found) > most:
        found = nlargest(most, found)
    enough = min(_MOST_COMPARED, max(1, _COMPARED_LETTERS // max(1, length)))
    if len(found) > enough:
        places = _places(word)
        found.sort(key=lambda one: _common(places, length, one[2]) / (length + len(one[2])), reverse=True)
    return [name for _, _, name in found[:enough]]


def _places(word: str) -> dict[str, int]:
    """Return the places of each letter of a word, one bit a place."""
    found: dict[str, int] = {}
    for place, letter in enumerate(word):
        found[letter] = found.get(letter, 0) | 1 << place
    return found


def _common(places: dict[str, int], length: int, name: str) -> int:
    """Return the length of the longest common subsequence of a word and a name, at most that of both.

    A row of the usual table is one integer: a bit is 0 where the row's value rises (Hyyrö, Bit-Parallel LCS-length Computation Revisited, 2004).

    Args:
        places: the places of the word's letters.
        length: of the word.
        name: another word.
    """
    row = whole = (1 << length) - 1
    for letter in name:
        met = row & places.get(letter, 0)
        row = ((row + met) | (row - met)) & whole
    return length - row.bit_count()


@lru_cache(maxsize=2048)
def _letters(word: str) -> int:
    """Return a bit for each letter of a word; letters may share one."""
    bits = 0
    for letter in word:
        bits |= 1 << (ord(letter) & 63)
    return bits


_MEANT = re.compile(r"\bdid you mean (\S+?)\?", re.IGNORECASE)


def suggested(help_: str) -> str:
    """The name that a help line says may be meant; empty where it says none."""
    found = _MEANT.search(help_)
    return found[1] if found else ""


class Collector:
    """Collects the findings of one source while a stage goes on; `place` is where in unrolled code it is."""

    def __init__(self, source: SourceFile) -> None:
        self.source = source
        self.found: list[Diagnostic] = []
        self.place = ""

    def add(
        self, code: str, message: str, span: Span | None = None, help_: str = "", fix: Fix | None = None
    ) -> None:
        """Add one finding."""
        self.found.append(Diagnostic(code, message, self.source, span, help_, fix, self.place))

    @property
    def has_errors(self) -> bool:
        """Whether an error was added."""
        return has_errors(self.found)
