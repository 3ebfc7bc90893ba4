"""The words of a line, however much of it is typed: what the parser refuses is taken apart here all the same."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from yarclang.memory import Lately

Kind = Literal["comment", "string", "frame", "open_frame", "index", "number", "word", "mark"]

_TOKEN = re.compile(
    r"""
      (?P<comment>!.*)
    | (?P<string>"[^"]*"?)
    | (?P<frame>\{[^{}!"]*\})
    | (?P<open_frame>\{[^{}\[\]();!"]*)
    | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![A-Za-z_]))
    | (?P<word>[A-Za-z_][A-Za-z0-9_.]*)
    | (?P<mark>\$\(|<>|<=|>=|\*\*|\S)
    """,
    re.VERBOSE,
)
_INDEX = re.compile(r"[Pp][0-9]+")


@dataclass(frozen=True, slots=True)
class Lexeme:
    """A piece of a line: `start` and `end` (not included) are columns from 1."""

    kind: Kind
    text: str
    start: int

    @property
    def end(self) -> int:
        """The first column behind it."""
        return self.start + len(self.text)

    @property
    def name(self) -> str:
        """The text as names are compared: in upper case, a frame's without braces."""
        return self.text.strip("{}").strip().upper()


def _read(line: str) -> tuple[Lexeme, ...]:
    """The pieces of one line; blanks are none."""
    found: list[Lexeme] = []
    for match in _TOKEN.finditer(line):
        kind: Kind = match.lastgroup  # type: ignore[assignment]
        if kind == "word" and not found and _INDEX.fullmatch(match[0]):
            kind = "index"
        found.append(Lexeme(kind, match[0], match.start() + 1))
    return tuple(found)


_KEPT = 1024
"""Lines that are kept at least, each some 1 to 2 kB; of longer texts whose words are coloured, all."""

lexemes_of = Lately(_read, _KEPT)
"""The same, for the lines that are looked at again and again."""


def lexeme_at(line: str, column: int) -> Lexeme | None:
    """The piece at a column from 1, or the one that ends there; None between two."""
    touched = [one for one in lexemes_of(line) if one.start <= column <= one.end]
    # of two that touch each other, the one that has a name: in `{B}|` or `$|X`
    named = [one for one in touched if one.kind not in {"mark", "comment"}]
    inside = [one for one in named if column < one.end]
    return next(iter(inside or named or touched), None)
