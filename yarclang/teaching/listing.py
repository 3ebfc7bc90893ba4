"""The text of a program as a list of commands. The text may have errors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from yarclang.assist.vocabulary import command_of
from yarclang.commands.registry import actions
from yarclang.commands.spec import ActionSpec
from yarclang.frozen import frozen
from yarclang.source import SourceFile
from yarclang.syntax.ast import Block, Node, Statement, Word
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import BLOCK_ENDS, DECLARATIONS, opens_block
from yarclang.teaching.edits import Program
from yarclang.teaching.fields import Field, Reader
from yarclang.teaching.indices import index_of, shown_index
from yarclang.teaching.points import meanings, point_of
from yarclang.words.spec import Slot

ListedKind = Literal["motion", "set", "wait", "hold", "call", "declaration", "block", "end", "other"]

_LONGEST = 200


@frozen
class Listed:
    """An entry of the list that shows a program: a command, a declaration, a comment line or a line that
    can't be parsed.

    Attributes:
        line: number of the entry's first line.
        rows: number of lines.
        depth: number of blocks that contain the entry.
        kind: kind of the line; "other" for comment lines and lines that can't be parsed.
        index: the index as written; empty if there is none.
        name: name of the command in upper case; "!" for a comment, "?" for a line that can't be parsed.
        title: name and values.
        detail: time, units, base frame, options, comment.
        target: form of a motion's end (joint values or a pose); None if the entry isn't a motion.
        taught: True if the entry contains a position that can be touched up.
        fields: the values that can be changed.
    """

    line: int
    rows: int
    depth: int
    kind: ListedKind
    index: str
    name: str
    title: str
    detail: str
    target: Literal["joints", "pose"] | None
    taught: bool
    fields: tuple[Field, ...] = ()


def listing(
    source: SourceFile, joints: tuple[str, ...] | None = None, lines: tuple[int, int] | None = None
) -> tuple[Listed, ...]:
    """List the entries of a program: commands, declarations, comment lines.

    Args:
        source: the program's text.
        joints: names of the robot's joints; None for J1 and so on.
        lines: first and last line for which fields are listed; None for all lines of a text of up to
            `MOST_WITH_FIELDS` lines, and for none of a longer text.
    """
    program = Program(source)
    if lines is None:
        lines = (1, program.size) if program.size <= MOST_WITH_FIELDS else (0, -1)
    return tuple(_Lister(program, joints, lines).all())


MOST_WITH_FIELDS = 1_000
"""Largest number of lines for which fields are listed without a request.

For a longer program, the fields of all lines would be megabytes that a browser had to load after each edit,
although nobody looks at all of them.
"""


class _Lister:
    def __init__(self, program: Program, joints: tuple[str, ...] | None, lines: tuple[int, int]) -> None:
        self._program = program
        self._first, self._last = lines
        self._reader = Reader(program.sketch, joints)
        self._depths: dict[int, int] = {}
        self._note(program.sketch.nodes, 0)

    def _note(self, nodes: tuple[Node, ...], depth: int) -> None:
        for node in nodes:
            if not isinstance(node, Block):
                self._depths[node.line] = depth - (node.name.name == "OF" and depth > 0)
                continue
            self._depths[node.head.line] = depth
            for one in (node.otherwise_head, node.end):
                if one is not None:
                    self._depths[one.line] = depth
            self._note((*node.body, *(node.otherwise or ())), depth + 1)

    def all(self) -> Iterator[Listed]:
        """Yield all entries in the order of the text."""
        program = self._program
        found: list[tuple[int, Statement | str | None]] = [
            *((one.line, one) for one in program.sketch.module.statements),
            *program.sketch.module.comment_lines,
            *((line, None) for line in program.unreadable),
        ]
        depth = 0
        for line, one in sorted(found, key=lambda entry: entry[0]):
            if isinstance(one, Statement):
                # A line that isn't in the block structure keeps the depth of the line before.
                depth = self._depths.get(line, depth)
                yield self._statement(one, depth)
                depth += opens_block(one) or one.name.name in ("ELSE", "OF")
            elif one is not None:
                yield Listed(line, 1, depth, "other", "", "!", _cut(one.lstrip("! ")), "", None, False)
            else:
                yield self._unreadable(line, depth)

    def _unreadable(self, line: int, depth: int) -> Listed:
        text = self._program.content(line)
        number = index_of(text)
        return Listed(
            line,
            self._program.unreadable[line],
            depth,
            "other",
            "" if number is None else shown_index(number),
            "?",
            _cut(text),
            "this line can't be read",
            None,
            False,
        )

    def _statement(self, one: Statement, depth: int) -> Listed:
        meant = meanings(one)
        kind = kind_of(one)
        targets = meant[-1:] if kind == "motion" else ()
        point = point_of(self._program.sketch, one, 0, meant) if meant else None
        title, detail = self._texts(one)
        return Listed(
            one.line,
            one.rows,
            depth,
            kind,
            one.index.name if one.index else "",
            one.name.name,
            title,
            detail,
            ("joints" if self._is_joints(one, targets[0].of_joints) else "pose") if targets else None,
            point is not None and not (kind == "declaration" and _is_tool(one)),
            tuple(placed.field for placed in self._reader.placed(one))
            if self._first <= one.line <= self._last
            else (),
        )

    def _is_joints(self, one: Statement, of_joints: bool) -> bool:
        """Return True if a motion ends at joint values.

        If the goal is a name, the result depends on its declaration, not on the suffix of the command: False
        for a pose, True for any other name. If the goal is written as values, return `of_joints`.
        """
        values = one.waypoints[-1].values if one.waypoints else ()
        if len(values) == 1 and isinstance(word := values[0], Word):
            symbol = self._program.sketch.names.meant(word.name, False, one.line)
            return symbol is None or symbol.kind != "pose"
        return of_joints

    def _texts(self, one: Statement) -> tuple[str, str]:
        """Return two texts of a command. The first is the title: the code before the time, units, base frame
        and options. The second is the detail: the rest of the code, and the comment.
        """
        if one.rows == 1:
            return self._text(one)
        rows = [self._program.content(one.line + row) for row in range(min(one.rows, 20))]
        begin = one.name.place.start - 1
        behind = [part.place for part in (one.time, one.units, one.base) if part is not None]
        behind += [option.word.place for option in one.options]
        code = [code_of(row) for row in rows]
        if behind and behind[0].row < len(rows):
            row, cut = behind[0].row, behind[0].start - 1
            title = " ".join((*code[:row], code[row][:cut]))
            detail = " ".join((code[row][cut:], *code[row + 1 :]))
        else:
            title, detail = " ".join(code), ""
        comments = " ".join(comment.text for comment in one.comments[:3])
        return _cut(title[begin:]), _cut(f"{detail} {comments}")

    def _text(self, one: Statement) -> tuple[str, str]:
        text = self._program.content(one.line)
        begin = one.name.place.start - 1
        end = len(code_of(text))
        part = one.time or one.units or one.base or (one.options[0].word if one.options else None)
        middle = part.place.start - 1 if part is not None else end
        return _cut(text[begin:middle]), _cut(text[middle:])


def _is_tool(one: Statement) -> bool:
    return one.base is not None and one.base.name in ("FLANGE", "TCP")


def kind_of(one: Statement) -> ListedKind:
    """Return the kind of a statement."""
    word = one.name.name
    if opens_block(one):
        return "block"
    if word in (*BLOCK_ENDS, "ELSE", "OF"):
        return "end"
    if word == "CALL":
        return "call"
    if (action := actions().get(word)) is not None:
        return _kind_of_action(action)
    if word in DECLARATIONS:
        return "declaration"
    found = command_of(word)
    return "motion" if found is not None and found[0].is_motion else "other"


def _kind_of_action(spec: ActionSpec) -> ListedKind:
    if {Slot.OUTPUT, Slot.TOOL} & {*spec.fullest.slots}:
        return "set"
    return "wait" if spec.takes_time or Slot.INPUT in spec.fullest.slots else "hold"


def _cut(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
