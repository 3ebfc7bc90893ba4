"""Arrange a file's statements in blocks: SUB, REPEAT, IF, WHEN, CASE, LOOP and WHILE, each up to its END
or UNTIL.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from yarclang.diagnostics import Collector, Diagnostic, Result
from yarclang.progress import each
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Block, Module, Node, Statement
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import BLOCK_ENDS, BLOCK_HEADS, DECLARATIONS, DECLARATIONS_IN_BLOCKS, opens_block
from yarclang.words.registry import word_specs

DEEPEST_BLOCK = 100
"""Largest depth of nested blocks."""

_WORD = re.compile(r"\s*(?:[Pp][0-9]+\s+)?([A-Za-z]+)(?![^\s;\[\](){}!,\"])")
_TOP_LEVEL = DECLARATIONS - DECLARATIONS_IN_BLOCKS - BLOCK_HEADS - BLOCK_ENDS - {"ELSE"} | {"SUB"}


def arrange(module: Module) -> Result[tuple[Node, ...]]:
    """Arrange the statements of a file in blocks.

    Returns:
        The statements and blocks in order, and a finding for each misplaced statement. The value is never
        None. If an END is missing, it is assumed at the end of the file, or before a line that can't be in a
        block. An END or ELSE without a block is dropped. The content of a block is dropped if the block's
        first line couldn't be read, or if the block is nested too deep. A statement that isn't allowed in its
        block stays there.
    """
    if not module.unreadable_lines and not any(map(_needs_arranging, module.statements)):
        return Result(module.statements)
    lines = [(one.line, one.name.name, one) for one in module.statements]
    arrangement = _Arrangement(module.source)
    both: list[tuple[int, str, Statement | None]] = [*lines]
    if module.unreadable_lines:
        both += [(line, _word(module.source.line(line)), None) for line in module.unreadable_lines]
        both.sort(key=lambda entry: entry[0])
    arrangement.missing = sum(
        (word in BLOCK_HEADS if one is None else opens_block(one)) - (word in BLOCK_ENDS)
        for _, word, one in both
    )
    for line, word, statement in each(both):
        arrangement.add(line, word, statement)
    return arrangement.finish()


def _needs_arranging(statement: Statement) -> bool:
    """Return True if a statement begins, divides or ends a block, or is a declaration with an index. If a
    program has no such statement, its statements needn't be arranged.
    """
    word = statement.name.name
    return (word in _ARRANGED and (statement.index is not None or word in _OF_BLOCKS)) or statement.waits_else


_OF_BLOCKS = BLOCK_HEADS | BLOCK_ENDS | {"ELSE"}
_ARRANGED = DECLARATIONS | _OF_BLOCKS


def _word(line: str) -> str:
    """Return the first word of a line that couldn't be read."""
    match = _WORD.match(code_of(line))
    return match.group(1).upper() if match else ""


@dataclass(slots=True)
class _Open:
    """A block whose END hasn't been read yet; `head` is None if the block's first line couldn't be read."""

    word: str
    line: int
    head: Statement | None
    body: list[Node] = field(default_factory=list)
    otherwise: list[Node] | None = None
    otherwise_head: Statement | None = None

    @property
    def nodes(self) -> list[Node]:
        """Return the list to which the next statement is added."""
        return self.body if self.otherwise is None else self.otherwise

    @property
    def takes_else(self) -> bool:
        """Return True if an ELSE is allowed next."""
        return self.otherwise is None and word_specs()[self.word].takes_else

    def closed(self, end: Statement | None) -> tuple[Block, ...]:
        """Return the finished block; empty if its first line couldn't be read."""
        if self.head is None:
            return ()
        otherwise = None if self.otherwise is None else tuple(self.otherwise)
        return (Block(self.head, tuple(self.body), otherwise, self.otherwise_head, end),)


class _Arrangement:
    """The statements and blocks that are finished, and the blocks that are open, innermost last."""

    def __init__(self, source: SourceFile) -> None:
        self.findings = Collector(source)
        self.nodes: list[Node] = []
        self.open: list[_Open] = []
        self.missing = 0
        """Number of ENDs that are missing in the file, without those that were already assumed."""
        self.too_deep = 0
        """Number of open blocks beyond the deepest level."""
        self.too_deep_told = False

    def add(self, line: int, word: str, statement: Statement | None) -> None:
        """Add the next line; `statement` is None if it couldn't be read."""
        if word in DECLARATIONS and statement is not None and statement.index is not None:
            span = statement.span(statement.index.place)
            self.findings.add("Y0117", f"{word} is no command and has no index", span, "remove the index")
        if word in _TOP_LEVEL and self.open and not self.too_deep and statement is not None:
            self._leave_blocks(statement)
        if word in BLOCK_HEADS or (statement is not None and statement.waits_else):
            self._begin(line, word, statement)
        elif word == "END":
            self._end(statement)
        elif word in BLOCK_ENDS:
            self._until(statement)
        elif word == "ELSE":
            self._otherwise(statement)
        elif statement is not None and not self.too_deep:
            self._nodes().append(statement)

    def finish(self) -> Result[tuple[Node, ...]]:
        """Return the statements and blocks after the last line."""
        while self.open:
            self._close("the end of the file")
        return Result(tuple(self.nodes), tuple(sorted(self.findings.found, key=_place)))

    def _nodes(self) -> list[Node]:
        return self.open[-1].nodes if self.open else self.nodes

    def _begin(self, line: int, word: str, head: Statement | None) -> None:
        if len(self.open) < DEEPEST_BLOCK and not self.too_deep:
            block = _Open(word, line, head)
            if word not in BLOCK_HEADS:  # a WAIT with its ELSE
                block.otherwise = []
            self.open.append(block)
            return
        self.too_deep += 1
        if not self.too_deep_told:
            span = head.span(head.name.place) if head else Span.on_line(line, 1, 2)
            message = f"more than {DEEPEST_BLOCK} blocks are nested"
            self.findings.add("Y0112", message, span, "move the inner blocks into a SUB")
            self.too_deep_told = True

    def _end(self, statement: Statement | None) -> None:
        if self.too_deep:
            self.too_deep -= 1
        elif self.open:
            block = self.open.pop()
            self._nodes().extend(block.closed(statement))
        else:
            self.missing += 1  # `missing` counted this END, but it ends no block
            if statement is not None:
                help_ = "remove it, or write the REPEAT, IF, WHEN, CASE, LOOP, WHILE or SUB that it ends"
                self._refuse("Y0114", "this END has no block to end", statement, help_)

    def _until(self, statement: Statement | None) -> None:
        """End the innermost LOOP. If other blocks are open inside it, report that their END is missing."""
        if self.too_deep:
            self.too_deep -= 1
            return
        loops = [number for number, block in enumerate(self.open) if block.word == "LOOP"]
        if loops and len(self.open) - 1 - loops[-1] <= self.missing:
            while len(self.open) - 1 > loops[-1]:
                self._close(f"this UNTIL in line {statement.line}" if statement else "UNTIL")
            self._end(statement)
        elif statement is not None:
            self.missing += 1  # `missing` counted this UNTIL, but it ends no block
            what = (
                f"the {self.open[-1].word} of line {self.open[-1].line} is open here"
                if self.open
                else "no block is open"
            )
            help_ = "write LOOP before the lines that are repeated"
            self._refuse("Y0114", f"this UNTIL has no LOOP to end: {what}", statement, help_)

    def _otherwise(self, statement: Statement | None) -> None:
        if self.too_deep:
            return
        takers = [number for number, block in enumerate(self.open) if block.takes_else]
        if takers and len(self.open) - 1 - takers[-1] <= self.missing:
            while len(self.open) - 1 > takers[-1]:
                self._close(f"this ELSE in line {statement.line}" if statement else "ELSE")
            self.open[-1].otherwise, self.open[-1].otherwise_head = [], statement
        elif statement is not None:
            self._refuse_else(statement)

    def _refuse_else(self, statement: Statement) -> None:
        if not self.open:
            help_ = "write ELSE between an IF, WHEN or CASE and its END"
            self._refuse("Y0114", "this ELSE is not in a block", statement, help_)
            return
        block = self.open[-1]
        if block.otherwise is not None:
            first = f" in line {block.otherwise_head.line}" if block.otherwise_head else ""
            message = f"the {block.word} of line {block.line} already has an ELSE{first}"
            help_ = "for a third case write an IF after the first ELSE, with an END of its own"
        else:
            message = (
                f"the {block.word} of line {block.line} is open here, and can't have an ELSE: only IF, WHEN "
                "and CASE can"
            )
            help_ = "remove it, or write the END that is missing above it"
        self._refuse("Y0115", message, statement, help_)

    def _leave_blocks(self, statement: Statement) -> None:
        """Handle a line that isn't allowed in any block, such as a declaration: either the END of the open
        blocks is missing, or the line is misplaced.
        """
        word = statement.name.name
        if len(self.open) <= self.missing:
            while self.open:
                self._close(f"the {word} in line {statement.line}")
            return
        block = self.open[-1]
        message = f"{word} isn't allowed in a block: the {block.word} of line {block.line} is open here"
        help_ = (
            f"move it above line {self.open[0].line}; blocks hold commands, FRAME, POSE, JOINTS, LET and "
            "blocks other than SUB"
        )
        self._refuse("Y0116", message, statement, help_)

    def _close(self, before: str) -> None:
        """Close the innermost block, whose END is missing."""
        block = self.open.pop()
        self.missing -= 1
        if block.head is not None:
            help_ = "write END after the last line of the block"
            self._refuse("Y0113", f"this {block.word} has no END before {before}", block.head, help_)
        self._nodes().extend(block.closed(None))

    def _refuse(self, code: str, message: str, statement: Statement, help_: str) -> None:
        self.findings.add(code, message, statement.span(statement.name.place), help_)


def _place(diagnostic: Diagnostic) -> tuple[Span, str]:
    assert diagnostic.span is not None  # every finding of this module has a place
    return diagnostic.span, diagnostic.code
