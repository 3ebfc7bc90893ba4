"""Links to the files that a program names: modules, cells, tables, robots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from yarclang.assist.view import View
from yarclang.semantics.files import values_of
from yarclang.source import Span
from yarclang.syntax.ast import Text, Word


@dataclass(frozen=True, slots=True)
class Link:
    """A range of a program that names a file. Editors can open the file from there.

    Attributes:
        span: the range.
        path: the file.
        what: kind of the file, in words.
    """

    span: Span
    path: Path
    what: str


def links(view: View, folder: Path) -> Iterator[Link]:
    """Yield the files that a program names, if they exist.

    Args:
        view: the program.
        folder: the program's folder.
    """
    for statement in view.sketch.module.statements:
        word = statement.name.name
        for value in values_of(statement):
            span = statement.span(value.place)
            if word == "USE" and isinstance(value, Word):
                module = view.module(value.name)
                if module is not None and Path(module.source.name).is_file():
                    yield Link(span, Path(module.source.name), f"the module {value.name}")
            elif isinstance(value, Text) and (path := folder / value.text[1:-1]).is_file():
                inside = Span(span.line, span.column + 1, span.end_line, span.end_column - 1)
                yield Link(inside, path, {"CELL": "the cell", "ROBOT": "the robot"}.get(word, "the table"))
