"""The lines that a user enters in a session: declarations remain in force, commands are carried out once. No
I/O.

A session is like one growing program. A new line is planned with all declarations that were accepted before.
Earlier commands aren't planned again, since they affect the new line only by the position in which they have
left the robot.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from pathlib import Path

from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Block, Module, Node, Statement, Word
from yarclang.syntax.blocks import arrange
from yarclang.syntax.words import DECLARATIONS

SESSION = "<session>"
"""Name that findings use in place of a file name for lines that were accepted earlier."""

TYPED = "<line>"
"""Name that findings use in place of a file name for the text that the user has just entered."""

_FILE = re.compile(
    r'^(?P<before>\s*(?:CELL|(?:P[0-9]+\s+)?MOVEJ_TIMED)\s+)"(?P<file>[^"\n]+)"', re.IGNORECASE | re.MULTILINE
)
"""Pattern for the beginning of a line that names a file: CELL (the file of a cell) or MOVEJ_TIMED (the file
of a trajectory).
"""

_STEP = 10
"""Step from one index to the next, for commands that the user enters without an index."""


@dataclass(frozen=True, slots=True)
class Parts:
    """A text's top-level declarations and commands, each as written, in order."""

    declarations: tuple[str, ...]
    commands: tuple[str, ...]
    count: int = 0
    """Number of lines with commands, including those in blocks."""


def parts_of(module: Module) -> Parts:
    """Split a text into the declarations, which remain in force, and the commands, which are carried out
    once.

    A block counts as a command, except a SUB, and an IF that contains only declarations.
    """
    nodes = arrange(module).value or ()
    declarations: list[str] = []
    commands: list[str] = []
    for node in nodes:
        text = _text(node, module.source)
        (declarations if _stays(node) else commands).append(text)
    return Parts(tuple(declarations), tuple(commands), sum(map(_commands, nodes)))


def numbered(module: Module, before: int, first: int) -> Module:
    """Return a parsed text in which every command has an index.

    Args:
        module: the text: the session's lines, followed by the new text.
        before: number of the session's lines. The commands in these lines are in SUBs, and are numbered
            separately.
        first: number in the index of the first command of the new text.
    """
    numbers = {True: first, False: _STEP}
    statements: list[Statement] = []
    for placed in module.statements:
        if placed.index is None and placed.name.name not in DECLARATIONS:
            own = placed.line > before
            placed = replace(placed, index=Word(f"P{numbers[own]:04d}", placed.name.place))  # noqa: PLW2901
            numbers[own] += _STEP
        statements.append(placed)
    return replace(module, statements=tuple(statements))


def _commands(node: Node) -> int:
    if isinstance(node, Block):
        return sum(map(_commands, (*node.body, *(node.otherwise or ()))))
    return int(not _stays(node))


def _stays(node: Node) -> bool:
    if isinstance(node, Block):
        # An IF that contains only declarations remains in force, because later lines may use its names.
        only_declares = node.head.name.name == "IF" and all(
            map(_stays, (*node.body, *(node.otherwise or ())))
        )
        return node.head.name.name == "SUB" or only_declares
    return node.index is None and node.name.name in DECLARATIONS


def _text(node: Node, source: SourceFile) -> str:
    """Return the lines of a statement or a block."""
    first = node.head if isinstance(node, Block) else node
    last = _last(node)
    return "\n".join(source.lines[first.line - 1 : last.line - 1 + last.rows])


def _last(node: Node) -> Statement:
    if not isinstance(node, Block):
        return node
    if node.end is not None:
        return node.end
    inside = node.otherwise or node.body
    return _last(inside[-1]) if inside else node.head


def seen_from(text: str, home: Path, folder: Path) -> str:
    """Rewrite the file names in CELL and MOVEJ_TIMED lines so that they lead from another folder to the same
    files. Absolute names aren't changed.

    Args:
        text: a declaration, a block or a command, as written.
        home: absolute path of the folder to which the file's name is relative.
        folder: absolute path of the new folder.
    """

    def renamed(named: re.Match[str]) -> str:
        if Path(named["file"]).is_absolute():
            return named[0]
        return f'{named["before"]}"{relative(home / named["file"], folder)}"'

    return _FILE.sub(renamed, text) if home != folder else text


def relative(path: Path, folder: Path) -> str:
    """Return a file's path relative to a folder; both are absolute."""
    return os.path.relpath(path, folder).replace(os.sep, "/")


@dataclass(frozen=True, slots=True)
class Typed:
    """A new text together with the session's declarations. `source` contains the declarations (the first
    `before` lines), followed by the text.
    """

    source: SourceFile
    before: int

    def placed(self, findings: tuple[Diagnostic, ...]) -> tuple[Diagnostic, ...]:
        """Return findings with line numbers relative to the beginning of the new text. Findings about lines
        of the session keep their line numbers.
        """
        typed = SourceFile(TYPED, "\n".join(self.source.lines[self.before :]) + "\n")
        return tuple(self._placed(one, typed) for one in findings)

    def _placed(self, finding: Diagnostic, typed: SourceFile) -> Diagnostic:
        span, fix = finding.span, finding.fix
        if finding.source != self.source or span is None or span.line <= self.before:
            return finding
        if fix is not None:
            edits = tuple(Edit(self._moved(edit.span), edit.text) for edit in fix.edits)
            within = all(edit.span.line > 0 for edit in edits)
            fix = Fix(fix.title, edits) if within else None  # fixes of the session's lines can't be applied
        return replace(finding, source=typed, span=self._moved(span), fix=fix)

    def _moved(self, span: Span) -> Span:
        return span._replace(line=span.line - self.before, end_line=span.end_line - self.before)


class Lines:
    """The declarations of a session, in their order.

    Attributes:
        declarations: the declarations, as written.
        count: number of commands that were carried out.
        revision: number that grows with each change of the declarations. Plans of an earlier revision may be
            invalid.
    """

    def __init__(self) -> None:
        self.declarations: list[str] = []
        self.count = 0
        self.revision = 0

    def copy(self) -> Lines:
        """Return a copy of the current lines."""
        made = Lines()
        made.declarations, made.count, made.revision = list(self.declarations), self.count, self.revision
        return made

    def behind(self, text: str) -> Typed:
        """Return a text after all declarations of the session."""
        before = "".join(f"{one}\n" for one in self.declarations)
        count = sum(one.count("\n") + 1 for one in self.declarations)
        return Typed(SourceFile(SESSION, before + text + "\n"), count)

    @property
    def next_number(self) -> int:
        """Return the number in the index that the next command gets if the user enters none."""
        return _STEP * (self.count + 1)

    def declare(self, declarations: tuple[str, ...]) -> None:
        """Add declarations."""
        if declarations:
            self.declarations += declarations
            self.revision += 1

    def adopt(self, declarations: tuple[str, ...]) -> None:
        """Replace all declarations by the given ones."""
        self.declarations = list(declarations)
        self.revision += 1

    def doubt(self) -> None:
        """Record that something to which the declarations refer, such as the cell, has changed."""
        self.revision += 1
