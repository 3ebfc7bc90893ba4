"""A line that can't be read, the program around it, and a guess of what the line was meant to be."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from functools import cached_property

from yarclang.commands.registry import commands
from yarclang.semantics.names.commands import is_command
from yarclang.source import SourceFile
from yarclang.suggestions import near
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import DECLARATIONS
from yarclang.units import UNITS

_PARTS = re.compile(r"(?P<index>\s*(?:[Pp][0-9]{1,9}(?![^\s]))?\s*)(?P<word>[A-Za-z_][A-Za-z0-9_]*)?")
_UNITS = re.compile(r"\(([A-Za-z]+(?:\s*,\s*[A-Za-z]+)*)\)")
_DECLARED = re.compile(
    r"^\s*(FRAME|FRAME_QUAT|LET|FUNC|TABLE|JOINTS|POSE|SUB|INPUT|OUTPUT"
    r"|REGISTER)\s+\{?([A-Za-z_][A-Za-z0-9_]*)",
    re.I,
)
_BLOCK = re.compile(r"^\s*(SUB|IF|WHEN|CASE|REPEAT|LOOP|WHILE|END)(?![A-Za-z0-9_])", re.I)
_LONGEST = 400
"""Largest number of characters in a line that is examined. Longer lines weren't typed by a person."""

_INDEX = re.compile(r"\s*[Pp]([0-9]{1,9})(?![^\s])")
_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


class Guess:
    """A guess of what a line that can't be read was meant to be.

    Args:
        begin: start of the mistake in the line, from 0.
        end: end of the mistake.
        message: message of the finding.
        help_: remedy.
        lines: the lines that replace the line, if one repair is likely.
    """

    __slots__ = ("begin", "begins_block", "end", "ends_block", "help", "lines", "message")

    def __init__(self, begin: int, end: int, message: str, help_: str, *lines: str) -> None:
        self.begin, self.end, self.message, self.help, self.lines = begin, end, message, help_, lines
        self.ends_block = False
        """True if the line was meant as END. The block then isn't reported as one without END."""
        self.begins_block = False
        """True if the line was meant to begin a block. An END further down then ends this block."""


Guesser = Callable[["Line"], Guess | None]


class Around:
    """The program around a line: its declared names, blocks, indices and units."""

    def __init__(self, source: SourceFile) -> None:
        self._source = source

    @cached_property
    def declared(self) -> dict[str, list[str]]:
        """Declared names as written, by the word that declares them."""
        found: dict[str, list[str]] = {}
        for line in self._source.lines:
            if match := _DECLARED.match(line[:_LONGEST]):
                found.setdefault(match[1].upper().removesuffix("_QUAT"), []).append(match[2])
        return found

    @cached_property
    def numbers(self) -> frozenset[str]:
        """Names that LET declares, in upper case."""
        return frozenset(one.upper() for one in self.declared.get("LET", ()))

    @cached_property
    def lines_of(self) -> dict[str, int]:
        """Number of the first line that declares each name, by the name in upper case."""
        found: dict[str, int] = {}
        for number, line in enumerate(self._source.lines, 1):
            if match := _DECLARED.match(line[:_LONGEST]):
                found.setdefault(match[2].upper(), number)
        return found

    def before(self, number: int) -> str:
        """Return the code of the line before line `number`, counted from 1; empty for the first line."""
        return code_of(self._source.line(number - 1)[:_LONGEST]) if number > 1 else ""

    def has_open_block(self, number: int) -> bool:
        """Return True if a block is open at line `number`, counted from 1."""
        depth = 0
        for line in self._source.lines[: number - 1]:
            if match := _BLOCK.match(line[:_LONGEST]):
                depth = max(0, depth + (-1 if match[1].upper() == "END" else 1))
        return depth > 0

    def free_index(self, number: int) -> str:
        """Return an unused index for a new command in line `number`, counted from 1."""
        indices = self._indices
        before = [one for line, one in indices if line < number]
        taken = {one for _, one in indices}
        place = (before[-1] if before else 0) + 10
        while place in taken:
            place += 1
        return f"P{place:04d}"

    @cached_property
    def _indices(self) -> list[tuple[int, int]]:
        lines = enumerate(self._source.lines, 1)
        return [(number, int(match[1])) for number, line in lines if (match := _INDEX.match(line))]

    def units_at(self, number: int) -> dict[str, str]:
        """Return the units of lengths, angles and times in line `number`, counted from 1: those that the line
        itself gives, or else those of a DEFAULT above it.
        """
        found: dict[str, str] = {}
        for line, units in self._defaults:
            if line < number:
                found |= units
        return found | _units_of(self._source.line(number))

    @cached_property
    def _defaults(self) -> list[tuple[int, dict[str, str]]]:
        lines = enumerate(self._source.lines, 1)
        return [(number, _units_of(line)) for number, line in lines if line.lstrip()[:7].upper() == "DEFAULT"]


def _units_of(line: str) -> dict[str, str]:
    """Return the units that a line gives, by kind."""
    names = (name.strip().lower() for match in _UNITS.finditer(code_of(line)) for name in match[1].split(","))
    return {UNITS[name].kind: name for name in names if name in UNITS}


class Line:
    """A line of a program, split into index, word, values and comment.

    Args:
        text: the line.
        number: number of the line, from 1.
        around: the program around the line.
        after: the next line.

    Attributes:
        bare: the code, without the comment.
        comment: the comment, with the blanks before it.
        index: the index with its blanks; empty without one.
        word: the first word after the index; empty without one.
        begin: place at which the word begins, from 0.
        behind: place at which the word ends.
        values: the code after the word.
    """

    def __init__(self, text: str, number: int, around: Around, after: str = "") -> None:
        self.text, self.number, self.around, self.after = text, number, around, after
        self.bare = code_of(text).rstrip()
        self.comment = text[len(self.bare) :]
        found = _PARTS.match(self.bare)
        assert found is not None  # the pattern matches an empty text, too
        self.index, self.word = found["index"], found["word"] or ""
        self.begin = len(self.index)
        self.behind = found.end()
        self.values = self.bare[self.behind :]

    @property
    def is_command(self) -> bool:
        """True if the word is the name of a command."""
        return is_command(self.word)

    @property
    def is_motion(self) -> bool:
        """True if the word is the name of a motion."""
        return any(self.word.upper() == one or self.word.upper().startswith(one + "_") for one in commands())

    @property
    def is_declaration(self) -> bool:
        """True if the word declares something, or begins or ends a block."""
        return self.word.upper() in DECLARATIONS

    @property
    def units(self) -> dict[str, str]:
        """The units of lengths, angles and times in this line."""
        return self.around.units_at(self.number)

    def with_(self, begin: int, end: int, put: str) -> str:
        """Return the whole line with the text between two places replaced."""
        return f"{self.text[:begin]}{put}{self.text[end:]}"

    def guess(self, begin: int, end: int, message: str, put: str | None = None, help_: str = "") -> Guess:
        """Return a guess about the mistake between two places of the line.

        Args:
            begin: start of the mistake, from 0.
            end: end of the mistake.
            message: message of the finding.
            put: text that replaces the mistake; None without a repair.
            help_: remedy; if empty, the repair in words.
        """
        lines = () if put is None else (self.with_(begin, end, put).rstrip(),)
        return Guess(begin, end, message, help_ or (f"write {put}" if put else "remove it"), *lines)


def is_number(text: str) -> bool:
    """Return True if a text is a valid number of the language."""
    return _NUMBER.fullmatch(text) is not None


_THOUSAND = re.compile(r"[-+]?[1-9][0-9]{0,2},[0-9]{3}")


def is_thousand(text: str) -> bool:
    """Return True if the comma in a number is ambiguous: it may separate thousands, or be a decimal comma."""
    return _THOUSAND.fullmatch(text) is not None


def first(line: Line, guessers: Iterable[Guesser]) -> Guess | None:
    """Return the guess of the first function that recognises a mistake in a line; None if none does."""
    return next((found for one in guessers if (found := one(line)) is not None), None)


def only(word: str, known: Iterable[str]) -> str:
    """Return the known name that is most similar to a word; empty if there is no similar name, or more
    than one.
    """
    found = near(word, known)
    return found[0] if len(found) == 1 else ""
