"""Text to syntax tree, one statement at a time.

This is the only module that knows Lark. Each statement is parsed for itself, so that a
fault costs one finding and nothing else, and an unchanged statement is parsed once.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from yarclang.diagnostics import Diagnostic, Result
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import (
    Comment,
    FrameName,
    Module,
    Number,
    Option,
    Other,
    Percent,
    Place,
    Statement,
    Text,
    Time,
    Units,
    WayPoint,
    Word,
)
from yarclang.syntax.words import DECLARATIONS

LONGEST_LINE = 100_000
"""Characters; a longer line is no program line but a file gone wrong."""

_NUMBER = re.compile(r"\S+")
_CODE = re.compile(r'(?:[^!"]|"[^"]*(?:"|$))*')  # a line up to its comment
_OPENS_STATEMENT = re.compile(
    rf"\s*(?:[Pp][0-9]+|{'|'.join(sorted(DECLARATIONS))})(?![^\s;\[\](){{}}!,\"])", re.I
)
_CLOSING = {"[": "]", "(": ")", "{": "}"}


@dataclass(frozen=True, slots=True)
class _Fault:
    """A syntax error, its place relative to the statement."""

    code: str
    message: str
    help: str
    place: Place


def parse(source: SourceFile) -> Result[Module]:
    """Parse a program.

    Returns:
        The tree of all statements that could be read, and a finding for each that couldn't.
        The value is never None.
    """
    statements: list[Statement] = []
    diagnostics: list[Diagnostic] = []
    unreadable: list[int] = []
    comment_lines: list[tuple[int, str]] = []
    for line, text in _statements(source):
        if len(text) > LONGEST_LINE and max(map(len, text.split("\n"))) > LONGEST_LINE:
            diagnostics.append(_too_long(source, line, text))
            unreadable.append(line)
            continue
        code = _code(text)
        if not code.strip():
            if text.strip():
                comment_lines.append((line, text.strip()))
            continue
        parsed = parse_statement(text)
        if isinstance(parsed, Statement):
            statements.append(replace(parsed, line=line))
        else:
            place = parsed.place
            span = Span.on_line(line + place.row, place.start, place.end)
            diagnostics.append(Diagnostic(parsed.code, parsed.message, source, span, parsed.help))
            unreadable.append(line)
    module = Module(source, tuple(statements), tuple(unreadable), tuple(comment_lines))
    return Result(module, tuple(diagnostics))


def _code(line: str) -> str:
    """A line without its comment."""
    match = _CODE.match(line)
    return match.group() if match else ""


def _statements(source: SourceFile) -> Iterator[tuple[int, str]]:
    """The statements' texts with the number of their first line; way-point lists that go on in
    further lines are one text with line ends inside.
    """
    lines = source.lines
    at = 0
    while at < len(lines):
        end = at + 1
        if len(lines[at]) <= LONGEST_LINE and _code(lines[at]).rstrip().endswith(";"):
            end = _end_of_list(lines, at)
        yield at + 1, "\n".join(lines[at:end])
        at = end


def _end_of_list(lines: tuple[str, ...], at: int) -> int:
    """The line behind a way-point list that begins in line `at` and ends with a semicolon."""
    end = ahead = at + 1
    while ahead < len(lines):
        code = _code(lines[ahead]) if len(lines[ahead]) <= LONGEST_LINE else "?"
        if not code.strip():
            ahead += 1
            continue
        if _OPENS_STATEMENT.match(code) or code == "?":
            return end
        end = ahead = ahead + 1
        if not code.rstrip().endswith(";"):
            return end
    return end


def _too_long(source: SourceFile, line: int, text: str) -> Diagnostic:
    return Diagnostic(
        "Y0106",
        f"this line has {len(text):,} characters; the longest that is read has {LONGEST_LINE:,}",
        source,
        Span.on_line(line, 1, 2),
        "break a way-point list after a semicolon; if this is no program, check which file was given",
    )


@lru_cache(maxsize=1 << 17)
def parse_statement(text: str) -> Statement | _Fault:
    """Parse the text of one statement; `line` of the result is 0 until the caller sets it."""
    from lark.exceptions import UnexpectedCharacters, UnexpectedEOF, UnexpectedToken

    lex_error: tuple[int, int] | None = None
    try:
        tree = _parser().parse(text)
    except UnexpectedToken as error:
        return _explain(text, error.token, set(error.accepts or error.expected), error.token_history)
    except UnexpectedEOF:
        return _Fault("Y0101", "the statement is not complete", "", _end_place(text))
    except UnexpectedCharacters as error:
        lex_error = (error.line, error.column)
    if lex_error is not None:
        return _stray(text, *lex_error)
    return _Builder(text).statement(tree)


@cache
def _parser() -> Any:
    from lark import Lark

    grammar = (Path(__file__).parent.parent / "grammar.lark").read_text(encoding="utf-8")
    return Lark(grammar, start="statement", parser="lalr", maybe_placeholders=False)


def _explain(text: str, token: Any, expected: set[str], history: Any) -> _Fault:
    """One sentence for a token that can't stand where it stands."""
    if token.type == "$END":
        for opening, name in (("[", "RSQB"), ("(", "RPAR")):
            if name in expected:
                return _unclosed(text, opening)
        end = _end_place(text)
        if "WORD" in expected and "NUMBERS" in expected:
            help_ = "write the next way-point, or take the semicolon away"
            return _Fault("Y0101", "the list of way-points ends with a semicolon", help_, end)
        return _Fault("Y0101", "a command's name is missing", _ORDER, end)
    place = _place(token)
    if "RSQB" in expected and token.type != "RSQB":
        return _unclosed(text, "[", place)
    if ("RPAR" in expected or "COMMA" in expected) and token.type in {"LSQB", "FRAME", "LPAR", "STRING"}:
        return _unclosed(text, "(", place)
    shown = str(token)
    what = {
        "FRAME": f"the frame {shown}",
        "LSQB": "a motion time",
        "LPAR": "a list of units",
        "NUMBERS": f"the value {shown.split(maxsplit=1)[0] if shown.split() else shown}",
        "INDEX": f"a second index {shown}",
        "_SEMICOLON": "a semicolon",
        "RSQB": "a closing bracket `]`",
        "RPAR": "a closing bracket `)`",
        "COMMA": "a comma",
        "STRING": "a text",
    }.get(token.type, f"`{shown[:40]}`")
    if token.type in {"RSQB", "RPAR"}:
        return _Fault("Y0102", f"{what} closes nothing", "take it away, or open the bracket", place)
    if token.type == "_SEMICOLON" or (history and getattr(history[-1], "type", "") == "_SEMICOLON"):
        return _Fault(
            "Y0101", "an empty way-point: two semicolons with nothing between", "take one away", place
        )
    if expected <= {"WORD", "INDEX"}:
        return _Fault(
            "Y0101", f"a statement begins with an index and a command's name, not with {what}", _ORDER, place
        )
    return _Fault("Y0101", f"{what} can't stand here", _ORDER, place)


_ORDER = (
    "the order is: index, name, {moving frame}, values, [motion time], (units), {base frame}, options; "
    "a comment starts with `!`"
)


def _stray(text: str, line: int, column: int) -> _Fault:
    """A character that begins no token: an opening brace or quote without its partner, or a closing one."""
    character = text.split("\n")[line - 1][column - 1]
    place = Place(line - 1, column, column + 1)
    if character in "{[(":
        return _unclosed(text, character, None, place)
    if character == '"':
        return _Fault("Y0102", "this text is not closed", 'close it with `"` in the same line', place)
    if character in "}])":
        return _Fault("Y0102", f"a closing bracket `{character}` closes nothing", "take it away", place)
    return _Fault(
        "Y0101", f"the character `{character}` (U+{ord(character):04X}) can't stand here", _ORDER, place
    )


def _unclosed(text: str, opening: str, before: Place | None = None, at: Place | None = None) -> _Fault:
    """An opening bracket without its partner: the last one before `before`, or the one `at`."""
    if at is None:
        rows = [_code(row) for row in text.split("\n")]
        row = before.row if before else len(rows) - 1
        column = rows[row].rfind(opening, 0, before.start - 1 if before else len(rows[row]))
        while column < 0 and row > 0:
            row -= 1
            column = rows[row].rfind(opening)
        at = Place(row, column + 1, column + 2)
    return _Fault("Y0102", f"this `{opening}` is not closed", f"close it with `{_CLOSING[opening]}`", at)


def _end_place(text: str) -> Place:
    rows = text.split("\n")
    end = len(_code(rows[-1]).rstrip()) + 1
    return Place(len(rows) - 1, end, end + 1)


def _place(token: Any) -> Place:
    return Place(token.line - 1, token.column, token.column + len(token))


class _Builder:
    """Makes a Statement of Lark's tree."""

    def __init__(self, text: str) -> None:
        self.text = text

    def statement(self, tree: Any) -> Statement:
        index: Word | None = None
        name: Word | None = None
        moving: FrameName | None = None
        base: FrameName | None = None
        time: Time | None = None
        units: Units | None = None
        waypoints: tuple[WayPoint, ...] = ()
        options: list[Option] = []
        for part in tree.children:
            kind = getattr(part, "data", None)
            if kind is None:
                index = Word(str(part), _place(part))
            elif kind == "head":
                name = Word(str(part.children[0]), _place(part.children[0]))
                if len(part.children) > 1:
                    moving = FrameName(str(part.children[1]), _place(part.children[1]))
            elif kind == "values":
                waypoints = tuple(WayPoint(tuple(self.items(child.children))) for child in part.children)
            elif kind == "time":
                time = Time(tuple(self.items(part.children)), self.bracket("[", "]", part, name))
            elif kind == "units":
                units = Units(tuple(self.items(part.children)), self.bracket("(", ")", part, name))
            elif kind == "base":
                base = FrameName(str(part.children[0]), _place(part.children[0]))
            else:
                word, *argument = self.items(part.children)
                options.append(Option(word, argument[0] if argument else None))
        assert name is not None  # the grammar has no statement without a name
        rows = self.text.split("\n")
        comments = tuple(
            Comment(row[len(code) :].rstrip(), Place(number, len(code) + 1, len(row.rstrip()) + 1))
            for number, row in enumerate(rows)
            if len(code := _code(row)) < len(row)
        )
        return Statement(
            0, len(rows), index, name, moving, waypoints, time, units, base, tuple(options), comments
        )

    def items(self, tokens: Any) -> Iterator[Any]:
        """Tokens as values; a run of numbers becomes its numbers."""
        for token in tokens:
            place = _place(token)
            if token.type == "NUMBERS":
                for match in _NUMBER.finditer(token):
                    start = place.start + match.start()
                    text = match.group()
                    yield Number(text, float(text), Place(place.row, start, start + len(text)))
            elif token.type == "PERCENT":
                yield Percent(str(token), float(str(token).rstrip("% \t")), place)
            elif token.type in {"WORD", "OPTION"}:
                yield Word(str(token), place)
            elif token.type == "STRING":
                yield Text(str(token), place)
            else:
                yield Other(str(token), place)

    def bracket(self, opening: str, closing: str, tree: Any, name: Word | None) -> Place:
        """The place of a bracket with its content; Lark drops the brackets themselves."""
        rows = self.text.split("\n")
        if tree.children:
            first = _place(tree.children[0])
            row, start = first.row, rows[first.row].rfind(opening, 0, first.start) + 1
        else:
            row = next(number for number, text in enumerate(rows) if opening in _code(text))
            start = rows[row].find(opening, name.place.end if name else 0) + 1
        end = rows[row].find(closing, start) + 1
        return Place(row, start, (end or len(rows[row])) + (1 if end else 0))
