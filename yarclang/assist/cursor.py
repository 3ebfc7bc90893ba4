"""The place in a statement at which the user is typing. The statement may be incomplete."""

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
    """The tokens of a statement before a place, for completion.

    Attributes:
        line: line of the place, from 1.
        start: column at which the token that is being typed begins.
        text: this token, up to the place; empty between two tokens.
        kind: kind of this token; empty between two tokens.
        before: the previous tokens, from the beginning of the statement, without the index.
        has_index: True if the statement has an index.
        head: first word of the statement, in upper case; empty if it isn't complete yet.
        bracket: innermost open bracket: `[`, `(`, `$(` or empty.
        inside: the tokens in this bracket.
        is_glued: True if a `$` is immediately before the token.
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
        """Return True if the place is in a comment."""
        return self.kind == "comment"

    @property
    def is_head(self) -> bool:
        """Return True if the statement's first word is being typed or is still missing."""
        return not self.head

    @property
    def is_expression(self) -> bool:
        """Return True if the place is in an expression."""
        if self.bracket == "$(" or (self.bracket == "[" and self._is_index):
            return True
        if self.head == "IF":
            return True
        return self.is_decided or (self.head == "LET" and any(one.text == "=" for one in self.before))

    @property
    def _is_index(self) -> bool:
        """Return True if the open `[` is in an expression, after a table's name."""
        opened: list[str] = []
        for one in self.before:
            if one.text in {"[", "(", "$("}:
                opened.append(one.text)
            elif one.text in _CLOSING and opened:
                opened.pop()
        return "$(" in opened

    @property
    def is_decided(self) -> bool:
        """Return True if the place is in an expression that is evaluated at run time."""
        marks = {"SET": {"="}, **dict.fromkeys(("WHEN", "WAIT", "WHILE", "UNTIL"), _OF_CONDITIONS)}.get(
            self.head, set()
        )
        return any(one.text.upper() in marks for one in self.before)

    @property
    def values(self) -> tuple[Lexeme, ...]:
        """Return the complete values before the place that belong to the same waypoint."""
        lexemes: list[Lexeme] = []
        depth = 0
        for one in self.before[1:]:
            if one.text in {"[", "(", "$("}:
                depth += 1
            if one.text == ";" and not depth:
                lexemes.clear()
            elif (one.kind in _VALUES and not depth) or (depth == 1 and one.text == "$("):
                lexemes.append(one)
            if one.text in {"]", ")"}:
                depth = max(depth - 1, 0)
        return tuple(lexemes[:-1] if self.bracket == "$(" else lexemes)

    @property
    def way_point(self) -> int:
        """Return the number of the waypoint that contains the place, from 0."""
        return sum(one.text == ";" for one in self.before)

    @property
    def option(self) -> str:
        """Return the option whose argument is expected next; empty if there is none."""
        if self.before and not self.bracket and self.before[-1].kind == "word":
            return self.before[-1].name if self.before[-1].name in OPTIONS else ""
        return ""

    def has(self, mark: str) -> bool:
        """Return True if the statement has a certain token before the place."""
        return any(one.text == mark for one in self.before)


def cursor_at(sketch: Sketch, line: int, column: int) -> Cursor:
    """Return the tokens of the statement before a column (from 1)."""
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
    """Return the first word of a statement."""
    return before[0].name if before and before[0].kind == "word" else ""


def _open(before: tuple[Lexeme, ...]) -> tuple[str, tuple[Lexeme, ...]]:
    """Return the innermost open bracket, and the tokens in it."""
    opened: list[tuple[str, int]] = []
    for number, one in enumerate(before):
        if one.text in {"[", "(", "$("}:
            opened.append((one.text, number + 1))
        elif one.text in _CLOSING and opened:
            opened.pop()
    if not opened:
        return "", ()
    # A bracket inside an expression belongs to the expression.
    kind = "$(" if any(text == "$(" for text, _ in opened) else opened[-1][0]
    return kind, before[opened[-1][1] :]
