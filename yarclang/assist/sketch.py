"""The statements, blocks and names of a text, without evaluation. They exist even for a text with errors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from yarclang.assist.symbols import Names, Symbol, Use, ends_of, names_of
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Module, Node, Statement
from yarclang.syntax.blocks import arrange
from yarclang.syntax.lines import code_of
from yarclang.syntax.parse import parse


@dataclass(frozen=True, eq=False)
class Sketch:
    """A text and its syntax tree.

    Attributes:
        source: the text.
        module: its syntax tree.
    """

    source: SourceFile
    module: Module

    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """Return the statements in their blocks."""
        arranged = arrange(self.module).value
        assert arranged is not None  # arranging always returns a tree
        return arranged

    @cached_property
    def names(self) -> Names:
        """Return the declared and used names of the text."""
        return names_of(self.nodes)

    @cached_property
    def ends(self) -> dict[int, int]:
        """Return the last line of each block, by the block's first line."""
        return ends_of(self.nodes)

    @cached_property
    def _by_line(self) -> dict[int, Statement]:
        return {one.line + row: one for one in self.module.statements for row in range(max(one.rows, 1))}

    def statement_at(self, line: int) -> Statement | None:
        """Return the statement to which a line belongs; None if it can't be parsed."""
        return self._by_line.get(line)

    def begin_of(self, line: int) -> int:
        """Return the first line of the list of waypoints that contains a line; otherwise the line itself."""
        above = line - 1
        begin = line
        while above > 0:
            code = code_of(self.source.line(above)).rstrip()
            if code.endswith(";"):
                begin = above
            elif code:
                break
            above -= 1
        return begin

    @cached_property
    def default(self) -> Statement | None:
        """Return the DEFAULT line."""
        return next(
            (one for one in self.module.statements if one.index is None and one.name.name == "DEFAULT"), None
        )

    def named_at(self, line: int, column: int) -> Symbol | Use | None:
        """Return the declaration or use of a name at a place (line and column from 1).

        The place directly after the name, and a frame's braces, belong to the name.
        """
        named: list[Symbol | Use] = [*self.names.symbols, *self.names.uses]
        found = [one for one in named if _touches(one.span, line, column, int(one.is_frame))]
        inside = [one for one in found if column < one.span.end_column]
        return next(iter(inside or found), None)


def sketch_of(source: SourceFile) -> Sketch:
    """Return the statements, blocks and names of a text."""
    module = parse(source).value
    assert module is not None  # parsing always returns a tree
    return Sketch(source, module)


def _touches(span: Span, line: int, column: int, around: int) -> bool:
    return span.line == line and span.column - around <= column <= span.end_column + around
