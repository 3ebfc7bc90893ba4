"""Build the outline of a file as a tree, and find its blocks that can be folded."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from yarclang.assist.sketch import Sketch
from yarclang.assist.symbols import Symbol
from yarclang.source import Span
from yarclang.syntax.ast import Block, Node, Statement
from yarclang.syntax.lines import code_of

Kind = Literal[
    "frame",
    "number",
    "table",
    "function",
    "joints",
    "pose",
    "register",
    "input",
    "output",
    "sub",
    "module",
    "block",
    "command",
]


@dataclass(frozen=True, slots=True)
class Entry:
    """An entry in the outline of a file: a declaration, a block or a command.

    Attributes:
        name: name that is shown.
        detail: text that is shown after the name.
        kind: kind of the entry.
        span: the whole range of lines that it stands for.
        name_span: the range that an editor selects.
        children: the entries inside a block.
    """

    name: str
    detail: str
    kind: Kind
    span: Span
    name_span: Span
    children: tuple[Entry, ...] = ()


@dataclass(frozen=True, slots=True)
class Fold:
    """A range of lines that can be folded; only the first line is then shown.

    Attributes:
        first: first line, from 1.
        last: last line.
        is_comment: True if the lines are comments.
    """

    first: int
    last: int
    is_comment: bool = False


MOST_COMMANDS = 2_000
"""Largest number of commands in an outline. Longer outlines are useless, and would be rebuilt after each
edit.
"""


def outline(sketch: Sketch) -> tuple[Entry, ...]:
    """Return the outline of a file: declarations, SUBs and other blocks with their contents, and commands
    unless there are too many.
    """
    symbols = {one.statement.line: one for one in sketch.names.symbols if one.kind != "parameter"}
    maker = _Maker(sketch, symbols, len(sketch.module.statements) - len(symbols) <= MOST_COMMANDS)
    return tuple(maker.entries(sketch.nodes))


@dataclass(frozen=True, slots=True)
class _Maker:
    sketch: Sketch
    symbols: dict[int, Symbol]
    has_commands: bool

    def entries(self, nodes: Iterable[Node]) -> Iterator[Entry]:
        for node in nodes:
            if isinstance(node, Block):
                yield self._block(node)
            elif (entry := self._entry(node)) is not None:
                yield entry

    def _block(self, block: Block) -> Entry:
        head, sketch = block.head, self.sketch
        children = tuple(self.entries((*block.body, *(block.otherwise or ()))))
        last = max([head.line + head.rows - 1, *(child.span.end_line for child in children)])
        if block.end is not None:
            last = block.end.line
        span = Span(head.line, 1, last, len(sketch.source.line(last)) + 1)
        symbol = self.symbols.get(head.line)
        if head.name.name == "SUB" and symbol is not None:
            return Entry(symbol.name, _code(sketch, head), "sub", span, symbol.span, children)
        return Entry(_code(sketch, head), "", "block", span, head.head_span, children)

    def _entry(self, statement: Statement) -> Entry | None:
        sketch, symbol = self.sketch, self.symbols.get(statement.line)
        if symbol is not None and symbol.kind != "parameter":
            name = f"{{{symbol.name}}}" if symbol.is_frame else symbol.name
            return Entry(name, _code(sketch, statement), symbol.kind, statement.whole_span, symbol.span)
        if statement.index is None or not self.has_commands:
            return None
        name = f"{statement.index.name} {statement.name.name}"
        rest = _code(sketch, statement).removeprefix(name).strip()  # without the name: an editor shows both
        return Entry(name, rest, "command", statement.whole_span, statement.head_span)


def _code(sketch: Sketch, statement: Statement) -> str:
    return " ".join(code_of(sketch.source.line(statement.line)).split())


def folds(sketch: Sketch) -> tuple[Fold, ...]:
    """Return the ranges of lines that can be folded: blocks up to their ELSE or END, lists of waypoints, and
    comments of several lines.
    """
    return tuple(
        sorted((*_block_folds(sketch.nodes), *_list_folds(sketch), *_comment_folds(sketch)), key=_order)
    )


def _order(fold: Fold) -> tuple[int, int]:
    return fold.first, -fold.last


def _block_folds(nodes: Iterable[Node]) -> Iterator[Fold]:
    for node in nodes:
        if not isinstance(node, Block):
            continue
        end = node.end.line - 1 if node.end else None
        turn = node.otherwise_head.line - 1 if node.otherwise_head else end
        if turn is not None and turn > node.head.line:
            yield Fold(node.head.line, turn)
        if node.otherwise_head is not None and end is not None and end > node.otherwise_head.line:
            yield Fold(node.otherwise_head.line, end)
        yield from _block_folds((*node.body, *(node.otherwise or ())))


def _list_folds(sketch: Sketch) -> Iterator[Fold]:
    for one in sketch.module.statements:
        if one.rows > 1:
            yield Fold(one.line, one.line + one.rows - 1)


def _comment_folds(sketch: Sketch) -> Iterator[Fold]:
    lines = [line for line, _ in sketch.module.comment_lines]
    first = 0
    for number, line in enumerate(lines):
        if number + 1 == len(lines) or lines[number + 1] != line + 1:
            if number > first:
                yield Fold(lines[first], line, is_comment=True)
            first = number + 1
