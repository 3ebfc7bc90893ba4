"""Split a line into tokens, even if the parser rejects the line."""

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
    """A token of a line.

    Attributes:
        kind: kind of the token.
        text: its characters.
        start: its first column, from 1.
    """

    kind: Kind
    text: str
    start: int

    @property
    def end(self) -> int:
        """Return the first column after the token."""
        return self.start + len(self.text)

    @property
    def name(self) -> str:
        """Return the token's text in the form in which names are compared: in upper case, a frame without
        braces.
        """
        return self.text.strip("{}").strip().upper()


def _read(line: str) -> tuple[Lexeme, ...]:
    """Split a line into its tokens. Blanks are left out."""
    found: list[Lexeme] = []
    for match in _TOKEN.finditer(line):
        kind: Kind = match.lastgroup  # type: ignore[assignment]
        if kind == "word" and not found and _INDEX.fullmatch(match[0]):
            kind = "index"
        found.append(Lexeme(kind, match[0], match.start() + 1))
    return tuple(found)


_KEPT = 1024
"""Number of lines that the cache can always hold; each takes 1 to 2 kB. If a longer text is coloured, the
cache holds all of its lines.
"""

lexemes_of = Lately(_read, _KEPT)
"""Return the tokens of one line. They are cached, because the same lines are read many times."""


def lexeme_at(line: str, column: int) -> Lexeme | None:
    """Return the token at a column (from 1), or the token that ends there; None between two tokens."""
    touched = [one for one in lexemes_of(line) if one.start <= column <= one.end]
    # If two tokens touch at the column, which is shown as | in `{B}|` and `$|X`, prefer the token with a
    # name.
    named = [one for one in touched if one.kind not in {"mark", "comment"}]
    inside = [one for one in named if column < one.end]
    return next(iter(inside or named or touched), None)
