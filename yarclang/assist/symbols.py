"""The names of a file: their declarations, the lines in which they may be used, and their uses.

As in the language, frames have separate names. Nothing is evaluated, so that texts with errors and
blocks that never run are included.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

from yarclang.semantics.control.conditional import known_behind
from yarclang.semantics.files import values_of
from yarclang.source import Span
from yarclang.syntax.ast import (
    Block,
    Computed,
    ComputedPercent,
    FrameName,
    NamedValue,
    Node,
    Parameter,
    Statement,
    Word,
)
from yarclang.syntax.expressions import Expression, Name, parts_of
from yarclang.syntax.words import CONSTANTS, STATES

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
    "parameter",
]

_BY_WORD: dict[str, Kind] = {
    "LET": "number",
    "TABLE": "table",
    "FUNC": "function",
    "REGISTER": "register",
    "JOINTS": "joints",
    "POSE": "pose",
    "INPUT": "input",
    "OUTPUT": "output",
    "USE": "module",
}
_FRAMES = ("FRAME", "FRAME_QUAT")
_END = 1 << 30


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name that a file declares.

    Attributes:
        kind: kind of the name.
        name: in upper case.
        is_frame: True if it names a frame.
        span: place of the name, for a frame without braces.
        statement: the declaration.
        first: line after which the name may be used.
        last: last line in which the name may be used.
        inside: the SUB that contains the declaration; empty outside of SUBs.
    """

    kind: Kind
    name: str
    is_frame: bool
    span: Span
    statement: Statement
    first: int
    last: int
    inside: str = ""

    def is_known_in(self, line: int) -> bool:
        """Return True if the name may be used in a line."""
        return self.first < line <= self.last


@dataclass(frozen=True, slots=True)
class Use:
    """A use of a name.

    Attributes:
        name: in upper case.
        is_frame: True if it names a frame.
        span: place of the name.
        module: module that is written before the name; empty without one.
        sub: the called SUB, in upper case, if this is the name before an argument of a CALL; else empty.
        symbol: its declaration, if it is in this file.
    """

    name: str
    is_frame: bool
    span: Span
    module: str = ""
    symbol: Symbol | None = None
    sub: str = ""


@dataclass(slots=True)
class Names:
    """The names of a file.

    Attributes:
        symbols: declarations, in order.
        uses: all uses of names, including undeclared ones.
    """

    symbols: list[Symbol] = field(default_factory=list)
    uses: list[Use] = field(default_factory=list)
    _by_name: dict[tuple[str, bool], list[Symbol]] = field(default_factory=dict)

    def add(self, symbol: Symbol) -> None:
        """Add a declaration."""
        self.symbols.append(symbol)
        self._by_name.setdefault((symbol.name, symbol.is_frame), []).append(symbol)

    def known_in(self, line: int) -> Iterator[Symbol]:
        """Yield the declarations whose names may be used in a line, in reverse order."""
        return (one for one in reversed(self.symbols) if one.is_known_in(line))

    def meant(self, name: str, is_frame: bool, line: int) -> Symbol | None:
        """Return the declaration to which a name without a module refers in a line."""
        named = reversed(self._by_name.get((name, is_frame), []))
        return next((one for one in named if one.is_known_in(line)), None)

    def declared(self, name: str, is_frame: bool) -> Symbol | None:
        """Return the declaration of a name that other files can use if they load this file as a module. Such
        a declaration is outside of blocks.
        """
        named = self._by_name.get((name, is_frame), [])
        return next((one for one in named if one.last == _END and not one.inside), None)

    def parameter(self, sub: str, name: str, is_frame: bool) -> Symbol | None:
        """Return the declaration of a SUB's parameter by its name; None if there is none."""
        named = self._by_name.get((name, is_frame), [])
        return next((one for one in named if one.kind == "parameter" and one.inside == sub), None)

    def meant_by(self, use: Use) -> Symbol | None:
        """Return the declaration in this file that another file uses as `MODULE.NAME`, or as a parameter's
        name.
        """
        if use.sub:
            return self.parameter(use.sub, use.name, use.is_frame)
        return self.declared(use.name, use.is_frame)


def names_of(nodes: tuple[Node, ...]) -> Names:
    """Return the names that are declared and used in the statements and blocks of a file."""
    reader = _Reader()
    reader.nodes(nodes, _END, "")
    return reader.names


class _Reader:
    def __init__(self) -> None:
        self.names = Names()
        self._behind: dict[tuple[str, bool], int] = {}
        """Names that stay known after the surrounding IF, with the last line in which each is known."""

    def nodes(self, nodes: tuple[Node, ...], last: int, inside: str) -> None:
        for node in nodes:
            if isinstance(node, Block):
                self._block(node, last, inside)
            else:
                self._statement(node, last, inside)

    def _block(self, block: Block, last: int, inside: str) -> None:
        head = block.head
        end = block.end.line if block.end else _last_line(block)
        turn = block.otherwise_head.line if block.otherwise_head else end
        match head.name.name:
            case "SUB":
                inside = self._sub(head, end, last)
            case "REPEAT":
                self._repeat(head, end, inside)
            case _:
                self._speak_of_all(head)
        # A name that both branches of an IF declare is one symbol. Its first line declares the name, its
        # second line uses it.
        left = known_behind(block) if head.name.name == "IF" else ()
        before, self._behind = self._behind, {one: self._behind.get(one, last) for one in left}
        self.nodes(block.body, turn, inside)
        self.nodes(block.otherwise or (), end, inside)
        self._behind = before

    def _sub(self, head: Statement, end: int, last: int) -> str:
        values = values_of(head)
        if not values or not isinstance(first := values[0], Word | Parameter):
            return ""
        word = first.word if isinstance(first, Parameter) else first
        self._declare("sub", word.name, head.span(word.place), head, last)
        for value in values[1:]:
            match value:
                case FrameName():
                    self._declare_frame(value, head, end, word.name, "parameter")
                case Parameter(word=named) | (Word() as named):
                    if isinstance(value, Parameter) and value.default is not None:
                        self._speak_of(value.default, head)
                    self._declare("parameter", named.name, head.span(named.place), head, end, word.name)
        return word.name

    def _repeat(self, head: Statement, end: int, inside: str) -> None:
        values = values_of(head)
        if len(values) > 1 and isinstance(word := values[0], Word):
            for value in values[1:]:
                self._speak_of(value, head)
            self._declare("number", word.name, head.span(word.place), head, end, inside)
        else:
            self._speak_of_all(head)

    def _statement(self, statement: Statement, last: int, inside: str) -> None:
        word = statement.name.name
        own: FrameName | Word | None = None
        values = values_of(statement)
        first = values[0] if values else None
        if statement.index is None and word in _FRAMES and statement.moving is not None:
            own = statement.moving
        elif statement.index is None and word in _BY_WORD and isinstance(first, Word):
            own = first
        if word == "FUNC":
            line = statement.line
            for value in values[1:]:
                if isinstance(value, Parameter):
                    named = value.word
                    span = statement.span(named.place)
                    self.names.add(Symbol("parameter", named.name, False, span, statement, line - 1, line))
        self._speak_of_all(statement, own)
        if isinstance(own, FrameName):
            self._declare_frame(own, statement, last, inside, "frame")
        elif isinstance(own, Word):
            self._declare(_BY_WORD[word], own.name, statement.span(own.place), statement, last, inside)

    # Methods that read declarations.

    def _declare(
        self, kind: Kind, name: str, span: Span, statement: Statement, last: int, inside: str = ""
    ) -> None:
        self._add(
            Symbol(kind, name, False, span, statement, statement.line + statement.rows - 1, last, inside)
        )

    def _add(self, symbol: Symbol) -> None:
        """Add a declaration. If the other branch of an IF has declared the same name, add a use of it
        instead.
        """
        key = (symbol.name, symbol.is_frame)
        if key not in self._behind:
            self.names.add(symbol)
            return
        known = self.names.meant(*key, symbol.first + 1)
        if known is not None:
            self.names.uses.append(Use(symbol.name, symbol.is_frame, symbol.span, "", known))
        else:
            self.names.add(replace(symbol, last=self._behind[key]))

    def _declare_frame(
        self, frame: FrameName, statement: Statement, last: int, inside: str, kind: Kind
    ) -> None:
        span = _inner(statement, frame)
        line = statement.line + statement.rows - 1
        self._add(Symbol(kind, frame.name, True, span, statement, line, last, inside))

    # Methods that read uses of names.

    def _speak_of_all(self, statement: Statement, own: object = None) -> None:
        word = statement.name.name
        if statement.index is None and word in {"ROBOT", "CELL"}:
            return
        for frame in (statement.moving, statement.base):
            if frame is not None and frame is not own:
                self._speak_of(frame, statement)
        if statement.expression is not None:
            self._expression(statement.expression, statement)
        of_signal = statement.index is None and word in {"INPUT", "OUTPUT"}
        for waypoint in statement.waypoints:
            for value in waypoint.items:
                if value is not own and not (of_signal and isinstance(value, Word)):
                    self._speak_of(value, statement)
        for item in statement.time.items if statement.time else ():
            if not isinstance(item, Word):  # the words MIN and V name nothing
                self._speak_of(item, statement)
        for option in statement.options:
            self._speak_of(option.argument, statement)

    def _speak_of(self, value: object, statement: Statement) -> None:
        match value:
            case NamedValue(word=word, value=given):
                self._speak_of(given, statement)
                self._use_parameter(word, isinstance(given, FrameName), statement)
            case Word(name=name, place=place) if name not in STATES:
                self._use(name, False, statement.span(place), statement.line)
            case FrameName(name=name):
                self._use(name, True, _inner(statement, value), statement.line)
            case Computed(expression=expression) | ComputedPercent(expression=expression):
                self._expression(expression, statement)

    def _use_parameter(self, word: Word, is_frame: bool, statement: Statement) -> None:
        """Add the use of a parameter's name that is written before its argument."""
        called = values_of(statement)[0]
        if not isinstance(called, Word):
            return
        module, _, sub = called.name.rpartition(".")
        symbol = None if module else self.names.parameter(sub, word.name, is_frame)
        self.names.uses.append(
            Use(word.name, is_frame, statement.span(word.place), module, symbol, sub if module else "")
        )

    def _expression(self, expression: Expression, statement: Statement) -> None:
        if isinstance(expression, Name) and expression.name not in CONSTANTS:
            self._use(expression.name, False, statement.span(expression.place), statement.line)
        for part in parts_of(expression):
            self._expression(part, statement)

    def _use(self, name: str, is_frame: bool, span: Span, line: int) -> None:
        module, dot, inner = name.partition(".")
        meant = self.names.meant
        if not dot:
            self.names.uses.append(Use(name, is_frame, span, "", meant(name, is_frame, line)))
            return
        middle = span.column + len(module)
        front = Span.on_line(span.line, span.column, middle)
        self.names.uses.append(Use(module, False, front, "", meant(module, False, line)))
        behind = Span.on_line(span.line, middle + 1, span.end_column)
        self.names.uses.append(Use(inner, is_frame, behind, module))


def _inner(statement: Statement, frame: FrameName) -> Span:
    """Return the place of a frame's name between its braces."""
    inner = frame.text[1:-1]
    start = frame.place.start + 1 + len(inner) - len(inner.lstrip())
    return Span.on_line(statement.line + frame.place.row, start, start + len(inner.strip()))


def ends_of(nodes: tuple[Node, ...]) -> dict[int, int]:
    """Return the last line of each block, by the block's first line."""
    found: dict[int, int] = {}
    for node in nodes:
        if isinstance(node, Block):
            found[node.head.line] = _end_of(node)
            found |= ends_of((*node.body, *(node.otherwise or ())))
    return found


def _last_line(block: Block) -> int:
    """Return the last line of a block. If the block's END is missing, the statements that follow belong to
    it.
    """
    return max((_end_of(one) for one in (*block.body, *(block.otherwise or ()))), default=block.head.line)


def _end_of(node: Node) -> int:
    if isinstance(node, Block):
        return node.end.line if node.end else _last_line(node)
    return node.line + node.rows - 1
