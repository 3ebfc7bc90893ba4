"""Source text and the places in it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple


class Span(NamedTuple):
    """A stretch of source text.

    Lines and columns count from 1, columns in characters; `end_column` is the first
    column behind the stretch. A span may run over several lines.
    """

    line: int
    column: int
    end_line: int
    end_column: int

    @staticmethod
    def on_line(line: int, column: int, end_column: int) -> Span:
        """The columns `column` to `end_column` (not included) of one line."""
        return Span(line, column, line, end_column)


_LINE = re.compile(r"[^\r\n]*+(?:\r\n|\r|\n)|[^\r\n]++")


def lines_with_ends(text: str) -> list[str]:
    """Return the lines of a text with their ends: LF, CRLF or CR, and no other character."""
    return _LINE.findall(text)


@dataclass(frozen=True)
class SourceFile:
    """The text of one file under the name by which messages speak of it.

    `module` is the name of a module in upper case, as USE names it; empty for a program. `is_installed` is True of a module of the standard library: nobody edits
    it, and people know it by its name, not by its path.
    """

    name: str
    text: str
    module: str = field(default="", compare=False)
    is_installed: bool = field(default=False, compare=False)

    @property
    def called(self) -> str:
        """The name that people know the file by: an installed module's own name, else that of the file."""
        return self.module if self.is_installed else self.name

    @cached_property
    def lines(self) -> tuple[str, ...]:
        """The lines without their ends (LF, CRLF or CR), as `str.splitlines` never splits them:
        a form feed or a Unicode line separator inside a line stays there.
        """
        text = self.text.replace("\r\n", "\n").replace("\r", "\n")
        lines = text.split("\n")
        if lines[-1] == "":
            lines.pop()
        return tuple(lines)

    def line(self, number: int) -> str:
        """Line `number` (from 1), empty where the file has none."""
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""

    def whole_line(self, number: int) -> Span:
        """Return the span of line `number` (from 1), from its first column on."""
        return Span.on_line(number, 1, len(self.line(number)) + 1)
