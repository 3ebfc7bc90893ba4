"""Convert a program to its standard form, as `yarc fmt` writes it, and prove that its meaning stays the
same.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from itertools import zip_longest
from typing import Any

from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.internal_errors import internal_error
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Computed, ComputedPercent, FrameName, Module, Number
from yarclang.syntax.lines import code_of, texts_of
from yarclang.syntax.parse import parse
from yarclang.syntax.print import print_module
from yarclang.syntax.renumber import renumbered

_INDEX = re.compile(r"^\s*[Pp][0-9]+(?![^\s;\[\](){}!,\"])")
_TOO_LONG = "is longer than the longest allowed line"
_WITHOUT_MEANING = frozenset(["place", "line", "rows", "comments"])
"""Fields of a tree that describe a position, not a meaning."""


def usual_form(source: SourceFile, renumber: tuple[int, int] | None = None) -> Result[str]:
    """Convert a program to its standard form, and prove that its meaning is the same.

    Args:
        source: the program. The result has the line ends (CRLF or LF) that most lines of the program have.
        renumber: first number of the commands and the step to the next; None: the numbers stay.

    Returns:
        None if the program has syntax errors, or if the result isn't proved to have the same meaning.
    """
    parsed = parse(source)
    if parsed.value is None or parsed.diagnostics:
        return Result(None, parsed.diagnostics)
    try:
        module = parsed.value if renumber is None else renumbered(parsed.value, *renumber)
        text = print_module(module)
        difference = _difference(parsed.value, module, SourceFile(source.name, text))
    except Exception as error:  # a bug of ours: the program stays as it is
        return Result(None, (internal_error(error, source),))
    if difference is not None:
        return Result(None, (_unproved(source, *difference),))
    if source.text.count("\r\n") > source.text.count("\n") / 2:  # a file keeps its kind of line ends
        text = text.replace("\n", "\r\n")
    return Result(text)


def _unproved(source: SourceFile, line: int, what: str) -> Diagnostic:
    code, help_ = "Y2002", "this is a bug of yarclang: please report it together with this line"
    if what == _TOO_LONG:
        code, help_ = "Y0106", "break a waypoint list after a semicolon"
    message = f"the formatted line {what}: the file is not changed"
    return Diagnostic(code, message, source, Span.on_line(line, 1, max(len(source.line(line)), 1) + 1), help_)


@frozen
class _Row:
    """A line of a program that isn't empty: its code and its comment. If commands are renumbered, the code
    lacks the index.
    """

    line: int
    code: str
    comment: str


def _difference(original: Module, meant: Module, after: SourceFile) -> tuple[int, str] | None:
    """Find the first line of a program that has another meaning in the standard form.

    Args:
        original: the program as written.
        meant: the program, with new indices if commands are renumbered.
        after: the program's standard form.

    Returns:
        The number of this line, and a text with the difference; None if there is no such line.
    """
    if after.text == original.source.text:
        return None
    keeps_indices = meant is original
    before_rows, after_rows = (list(_rows(one, keeps_indices)) for one in (original.source, after))
    for row, other in zip(before_rows, after_rows, strict=False):
        if row.code != other.code and _squeezed(row.code) != _squeezed(other.code):
            return row.line, "has different words"
        if row.comment != other.comment:
            return row.line, "has a different comment"
    if len(before_rows) != len(after_rows):
        shorter = min(len(before_rows), len(after_rows))
        return (
            before_rows[shorter].line if shorter < len(before_rows) else 1
        ), "has a different number of lines"
    line_before = {other.line: row.line for row, other in zip(before_rows, after_rows, strict=True)}
    parsed = parse(after)
    if parsed.diagnostics or parsed.value is None:
        first = parsed.diagnostics[0]
        what = _TOO_LONG if first.code == "Y0106" else "can't be read"
        return line_before.get(first.span.line if first.span else 0, 1), what
    rewritten = {
        row.line for row, other in zip(before_rows, after_rows, strict=True) if row.code != other.code
    }
    read = parsed.value.statements
    for was, one, now in zip_longest(original.statements, meant.statements, read):
        if was is None or now is None:
            return original.statements[-1].line, "is read differently"
        is_rewritten = any(line in rewritten for line in range(was.line, was.line + was.rows))
        if is_rewritten and meaning(one) != meaning(now):  # equal code is parsed equally
            return was.line, "is read differently"
    again = SourceFile(after.name, print_module(parsed.value))
    if again.text != after.text:
        both = enumerate(zip(after.lines, again.lines, strict=False), 1)
        line = next((number for number, (one, other) in both if one != other), 1)
        return line_before.get(line, 1), "is formatted differently the second time"
    return None


def _rows(source: SourceFile, keeps_indices: bool) -> Iterator[_Row]:
    for number, line in enumerate(source.lines, 1):
        code = code_of(line)
        comment = line[len(code) :].rstrip()
        if not keeps_indices:
            code = _INDEX.sub("", code, count=1)
        code = code.strip()
        if code or comment:
            yield _Row(number, code, comment)


def _squeezed(code: str) -> str:
    """Return code in upper case and without blanks; texts in quotes aren't changed."""
    pieces: list[str] = []
    done = 0
    for text in texts_of(code):
        pieces += ("".join(code[done : text.start()].split()).upper(), text[0])
        done = text.end()
    return "".join((*pieces, "".join(code[done:].split()).upper()))


def meaning(part: Any) -> Any:
    """Return the meaning of a syntax tree or a node, for comparison. It has no positions; numbers are as
    written, and names are in upper case.
    """
    if isinstance(part, tuple):
        return tuple(map(meaning, part))
    if isinstance(part, Number):
        return part.text
    if isinstance(part, FrameName):
        return part.name
    if is_dataclass(part):
        kind: Any = type(part)
        return (kind.__name__, *(meaning(getattr(part, name)) for name in _telling(kind)))
    return part.upper() if isinstance(part, str) else part


@cache
def _telling(kind: Any) -> tuple[str, ...]:
    """Return the fields of a class of syntax nodes that have a meaning. A computed value is compared by its
    expression, not by its text.
    """
    left_out = _WITHOUT_MEANING | ({"text"} if issubclass(kind, Computed | ComputedPercent) else set())
    return tuple(field.name for field in fields(kind) if field.name not in left_out)
