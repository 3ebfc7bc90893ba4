"""Source texts and places in them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple


class Span(NamedTuple):
    """A range of source text, possibly of several lines.

    Attributes:
        line: first line, from 1.
        column: first column, from 1, counted in characters.
        end_line: last line.
        end_column: first column after the range.
    """

    line: int
    column: int
    end_line: int
    end_column: int

    @staticmethod
    def on_line(line: int, column: int, end_column: int) -> Span:
        """Return the span from `column` to `end_column` (exclusive) of one line."""
        return Span(line, column, line, end_column)


_LINE = re.compile(r"[^\r\n]*+(?:\r\n|\r|\n)|[^\r\n]++")


def lines_with_ends(text: str) -> list[str]:
    """Return the lines of a text with their line ends. Only LF, CRLF and CR are line ends."""
    return _LINE.findall(text)


@dataclass(frozen=True)
class SourceFile:
    """The text of one file.

    Attributes:
        name: name of the file in messages.
        text: the text.
        module: name of a module in upper case, as in USE; empty for a program.
        is_installed: True for a module of the standard library. Users don't edit it, and know it by its name,
            not by its path.
    """

    name: str
    text: str
    module: str = field(default="", compare=False)
    is_installed: bool = field(default=False, compare=False)

    @property
    def called(self) -> str:
        """Return the name that users know: an installed module's own name, otherwise the name of the file."""
        return self.module if self.is_installed else self.name

    @cached_property
    def lines(self) -> tuple[str, ...]:
        """Return the lines without their ends (LF, CRLF or CR).

        Unlike `str.splitlines`, this keeps a form feed or a Unicode line separator inside a line.
        """
        text = self.text.replace("\r\n", "\n").replace("\r", "\n")
        lines = text.split("\n")
        if lines[-1] == "":
            lines.pop()
        return tuple(lines)

    def line(self, number: int) -> str:
        """Return line `number` (from 1); empty if the file has no such line."""
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""

    def whole_line(self, number: int) -> Span:
        """Return the span of line `number` (from 1), from its first column on."""
        return Span.on_line(number, 1, len(self.line(number)) + 1)
