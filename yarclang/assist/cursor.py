"""Where in a statement somebody is typing, however much of it there is."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.assist.lexemes import Lexeme, lexemes_of
from yarclang.assist.sketch import Sketch
from yarclang.syntax.words import OPTIONS

_CLOSING = {"]": "[", ")": "("}
_OF_CONDITIONS = {"=", "<>", "<", "<=", ">", ">=", "AND", "OR", "NOT"}
_VALUES = {"number", "word", "frame", "string"}


@dataclass(frozen=True, slots=True)
class Cursor:
    """What stands in front of a place.

    Attributes:
        line: the place's line, from 1.
        start: the column where the piece begins that is being typed; `text` is it, up to the place. Empty between two pieces.
        kind: of that piece; empty between two.
        before: the pieces in front of it, from the beginning of the statement on, without the index.
        has_index: whether the statement has one.
        head: the statement's word in upper case; empty where it isn't there yet.
        bracket: the innermost bracket that is open: `[`, `(`, `$(` or nothing.
        inside: the pieces in that bracket.
        is_glued: whether a `$` stands right before the piece.
    """

    line: int
    start: int
    text: str
    kind: str
    before: tuple[Lexeme, ...]
    has_index: bool
    head: str
    bracket: str
    inside: tuple[Lexeme, ...]
    is_glued: bool

    @property
    def is_comment(self) -> bool:
        """Whether the place is in a comment."""
        return self.kind == "comment"

    @property
    def is_head(self) -> bool:
        """Whether the statement's word is being typed, or is to come."""
        return not self.head

    @property
    def is_expression(self) -> bool:
        """Whether an expression stands here."""
        if self.bracket == "$(" or (self.bracket == "[" and self._is_index):
            return True
        if self.head == "IF":
            return True
        return self.is_decided or (self.head == "LET" and any(one.text == "=" for one in self.before))

    @property
    def _is_index(self) -> bool:
        """True if the open `[` stands inside an expression, behind a table's name."""
        opened: list[str] = []
        for one in self.before:
            if one.text in {"[", "(", "$("}:
                opened.append(one.text)
            elif one.text in _CLOSING and opened:
                opened.pop()
        return "$(" in opened

    @property
    def is_decided(self) -> bool:
        """Whether an expression stands here whose value is known only when the program runs."""
        marks = {"SET": {"="}, **dict.fromkeys(("WHEN", "WAIT", "WHILE", "UNTIL"), _OF_CONDITIONS)}.get(
            self.head, set()
        )
        return any(one.text.upper() in marks for one in self.before)

    @property
    def values(self) -> tuple[Lexeme, ...]:
        """The finished values of the way-point that the place is in."""
        found: list[Lexeme] = []
        depth = 0
        for one in self.before[1:]:
            if one.text in {"[", "(", "$("}:
                depth += 1
            if one.text == ";" and not depth:
                found.clear()
            elif (one.kind in _VALUES and not depth) or (depth == 1 and one.text == "$("):
                found.append(one)
            if one.text in {"]", ")"}:
                depth = max(depth - 1, 0)
        return tuple(found[:-1] if self.bracket == "$(" else found)

    @property
    def way_point(self) -> int:
        """The number of the way-point that the place is in, from 0."""
        return sum(one.text == ";" for one in self.before)

    @property
    def option(self) -> str:
        """The option whose argument is to come; empty where none is."""
        if self.before and not self.bracket and self.before[-1].kind == "word":
            return self.before[-1].name if self.before[-1].name in OPTIONS else ""
        return ""

    def has(self, mark: str) -> bool:
        """Whether a mark stands in front of the place."""
        return any(one.text == mark for one in self.before)


def cursor_at(sketch: Sketch, line: int, column: int) -> Cursor:
    """The place in front of a column (from 1)."""
    begin = sketch.begin_of(line)
    pieces: list[Lexeme] = []
    for number in range(begin, line):
        pieces += [one for one in lexemes_of(sketch.source.line(number)) if one.kind != "comment"]
    text = sketch.source.line(line)
    here = list(lexemes_of(text[: column - 1]))
    piece: Lexeme | None = None
    if (here and here[-1].end == column and here[-1].kind not in {"mark", "frame"}) or (
        here and here[-1].kind == "comment"
    ):
        piece = here.pop()
    glued = bool(piece and here and here[-1].text == "$" and here[-1].end == piece.start) or (
        piece is None and bool(here) and here[-1].text == "$" and here[-1].end == column
    )
    pieces += here
    if piece is not None and piece.kind == "index" and pieces:
        piece = Lexeme("word", piece.text, piece.start)
    has_index = bool(pieces) and pieces[0].kind == "index"
    before = tuple(pieces[1:] if has_index else pieces)
    bracket, inside = _open(before)
    return Cursor(
        line=line,
        start=piece.start if piece else column,
        text=piece.text if piece else "",
        kind=piece.kind if piece else "",
        before=before,
        has_index=has_index,
        head=_head(before),
        bracket=bracket,
        inside=inside,
        is_glued=glued,
    )


def _head(before: tuple[Lexeme, ...]) -> str:
    """The word that a statement begins with."""
    return before[0].name if before and before[0].kind == "word" else ""


def _open(before: tuple[Lexeme, ...]) -> tuple[str, tuple[Lexeme, ...]]:
    """The innermost open bracket, and what stands in it."""
    opened: list[tuple[str, int]] = []
    for number, one in enumerate(before):
        if one.text in {"[", "(", "$("}:
            opened.append((one.text, number + 1))
        elif one.text in _CLOSING and opened:
            opened.pop()
    if not opened:
        return "", ()
    # a bracket in an expression belongs to it
    kind = "$(" if any(text == "$(" for text, _ in opened) else opened[-1][0]
    return kind, before[opened[-1][1] :]
