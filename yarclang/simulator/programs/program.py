"""Contents of program buffers. PROGs and PLCs have text and linked code; rotaries have lines that are removed
when they are calculated.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from yarclang.pmac.errors import BAD_PROGRAM, DATA, NO_ROOM, STRUCTURE
from yarclang.simulator.language.arithmetic import Condition
from yarclang.simulator.language.statements import If, Label, Plain, Statement, cost, in_rotary
from yarclang.simulator.network.reply import Refusal

LARGEST_PROGRAM = 2_000_000
"""Largest total number of words of all PROG and PLC buffers, which limits memory (assumed; on a real
controller it depends on the options).
"""


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a buffer.

    Attributes:
        text: text of the line.
        statements: statements of the line.
        words: number of words of memory that the line takes.
    """

    text: str
    statements: tuple[Statement, ...]
    words: int


@dataclass(slots=True)
class Branch:
    """A conditional jump in linked code.

    Attributes:
        condition: the jump is executed if this condition is false.
        target: index in the code at which the execution continues after the jump.
        wait: True to wait, and evaluate the condition again later, as long as it is true (WHILE ...
            WAIT).
    """

    condition: Condition
    target: int = -1
    wait: bool = False


@dataclass(slots=True)
class Go:
    """An unconditional jump in linked code.

    Attributes:
        target: index in the code at which the execution continues.
        back: True for the jump back at the end of a loop.
    """

    target: int = -1
    back: bool = False


Code = Statement | Branch | Go


def line_of(text: str, statements: tuple[Statement, ...]) -> Line:
    """Return a line of a buffer, with the number of words that the line takes in the buffer."""
    return Line(text, statements, sum(map(cost, statements)))


@dataclass(slots=True)
class Program:
    """A PROG or a PLC.

    Attributes:
        lines: lines of the program.
        words: number of words of memory that the lines take.
        open_blocks: names of the IFs and WHILEs that are open after the last line.
        single: True if the last line is an IF that applies only to its own line; an ELSE may follow it.
    """

    lines: list[Line] = field(default_factory=list)
    words: int = 0
    open_blocks: list[str] = field(default_factory=list)
    single: bool = False
    _code: tuple[list[Code], list[int], dict[int, int]] | None = None

    def clear(self) -> None:
        """Remove all lines."""
        self.lines.clear()
        self.open_blocks.clear()
        self.words, self.single, self._code = 0, False, None

    def copy(self) -> Program:
        """Return a program with the same lines. The copy links its own code."""
        return Program(list(self.lines), self.words, list(self.open_blocks))

    def append(self, line: Line) -> None:
        """Store a line.

        Raises:
            Refusal: ERR009 for an ELSE, ENDIF or ENDWHILE without an open IF or WHILE.
        """
        blocks, single = _followed(self.open_blocks, self.single, line)
        self.open_blocks, self.single = blocks, single
        self.lines.append(line)
        self.words += line.words
        self._code = None

    def code(self) -> tuple[list[Code], list[int], dict[int, int]]:
        """Return the linked code; for each item of the code, the index of its line; and for each label, its
        index in the code.

        Raises:
            Refusal: ERR016 if an IF or WHILE isn't closed.
        """
        if self._code is None:
            self._code = _linked(self.lines)
        return self._code


def _followed(open_blocks: list[str], single: bool, line: Line) -> tuple[list[str], bool]:
    """Return the names of the IFs and WHILEs that are open after a line, and True if the line is an IF that
    applies only to its own line.

    Args:
        open_blocks: the open IFs and WHILEs before the line.
        single: True if the previous line is an IF that applies only to its own line; an ELSE may follow it.
        line: the line.

    Raises:
        Refusal: ERR009 for an ELSE, ENDIF or ENDWHILE without an open IF or WHILE, or for more than 64 open
            blocks.
    """
    blocks = list(open_blocks)
    single_openers = 0
    for place, statement in enumerate(line.statements):
        if isinstance(statement, If) and statement.name in ("IF", "WHILE"):
            if _is_single(line.statements, place):
                single_openers += 1
            else:
                blocks.append(statement.name)
        elif isinstance(statement, Plain) and statement.name == "ELSE":
            if single_openers and place:
                continue
            if _for_single(single and place == 0, line, bool(blocks) and blocks[-1] == "IF"):
                if len(line.statements) == 1:
                    blocks.append("ELSE")
            elif blocks and blocks[-1] == "IF":
                blocks[-1] = "ELSE"
            else:
                raise Refusal(STRUCTURE)
        elif isinstance(statement, Plain) and statement.name in ("ENDIF", "ENDWHILE"):
            if not blocks or (blocks[-1] == "WHILE") != (statement.name == "ENDWHILE"):
                raise Refusal(STRUCTURE)
            blocks.pop()
    if len(blocks) > 64:
        raise Refusal(STRUCTURE)
    first_is_if = bool(line.statements) and isinstance(line.statements[0], If)
    return blocks, single_openers > 0 and first_is_if


def _for_single(single: bool, line: Line, block: bool) -> bool:
    """Return True if an ELSE belongs to the single-line IF before it, and not to an open IF block.

    The ELSE belongs to the single-line IF if the line of the ELSE also has an action, or if no block is open
    (assumed).
    """
    return single and (len(line.statements) > 1 or not block)


def _is_single(statements: tuple[Statement, ...], place: int) -> bool:
    """Return True if the IF or WHILE at `place` applies only to the rest of its line."""
    opener = statements[place]
    rest = statements[place + 1 :]
    while rest and isinstance(rest[0], If) and rest[0].name in ("AND", "OR"):
        rest = rest[1:]
    if not rest:
        return False
    end = "END" + opener.name if isinstance(opener, If) else ""
    depth = 0
    for statement in rest:
        if isinstance(statement, If) and statement.name in ("IF", "WHILE"):
            depth += 1
        elif isinstance(statement, Plain) and statement.name in ("ENDIF", "ENDWHILE"):
            if depth == 0:
                return statement.name != end
            depth -= 1
    return True


@dataclass(slots=True)
class _Open:
    """An IF or WHILE whose end hasn't been read yet.

    Attributes:
        name: IF or WHILE.
        at: index of its conditional jump in the code.
        single: True if the block ends at the end of its line.
        skip: index in the code of the jump over its ELSE block; None without an ELSE.
    """

    name: str
    at: int
    single: bool
    skip: int | None = None


def _linked(lines: list[Line]) -> tuple[list[Code], list[int], dict[int, int]]:
    code: list[Code] = []
    places: list[int] = []
    labels: dict[int, int] = {}
    opened: list[_Open] = []
    last_single: _Open | None = None

    def emit(item: Code, number: int) -> int:
        code.append(item)
        places.append(number)
        return len(code) - 1

    def close(block: _Open) -> None:
        if block.name == "WHILE":
            emit(Go(block.at, back=True), places[block.at])
        for at in (block.skip, block.at):
            target = code[at] if at is not None else None
            if isinstance(target, Branch | Go) and target.target < 0:
                target.target = len(code)

    for number, line in enumerate(lines):
        before = last_single
        last_single = None
        for place, statement in enumerate(line.statements):
            match statement:
                case If(name="AND" | "OR" as name, condition=condition):
                    if not code or not isinstance(code[-1], Branch):
                        raise Refusal(BAD_PROGRAM)
                    code[-1].condition = _joined(name, code[-1].condition, condition)
                case If(name=name, condition=condition):
                    follower = line.statements[place + 1] if place + 1 < len(line.statements) else None
                    waits = name == "WHILE" and follower == Plain("WAIT")
                    at = emit(Branch(condition, wait=waits), number)
                    opened.append(_Open(name, at, _is_single(line.statements, place)))
                case Plain(name="ELSE"):
                    around = opened[-1] if opened and opened[-1].name == "IF" else None
                    block = around
                    if (
                        before
                        and place == 0
                        and _for_single(True, line, bool(around and around.skip is None))
                    ):
                        block = before
                        block.single = len(line.statements) > 1
                        opened.append(block)
                    if block is None or block.name != "IF":
                        raise Refusal(BAD_PROGRAM)
                    block.skip = emit(Go(), number)
                    branch = code[block.at]
                    if isinstance(branch, Branch):
                        branch.target = len(code)
                case Plain(name="ENDIF" | "ENDWHILE" as name):
                    if not opened or opened[-1].name != name[3:]:
                        raise Refusal(BAD_PROGRAM)
                    close(opened.pop())
                case Plain(name="WAIT"):
                    pass
                case Label(number=label):
                    labels.setdefault(label, len(code))
                case _:
                    emit(statement, number)
        while opened and opened[-1].single:
            block = opened.pop()
            close(block)
            if block.name == "IF" and block.skip is None:
                last_single = block
    if opened:
        raise Refusal(BAD_PROGRAM)
    return code, places, labels


def _joined(name: str, first: Condition, second: Condition) -> Condition:
    if name == "AND":
        return lambda scope: first(scope) and second(scope)
    return lambda scope: first(scope) or second(scope)


class Rotary:
    """A rotary buffer: lines that are removed when they are calculated (TUM 337, PUM 211-213).

    Attributes:
        size: largest number of words.
        lines: the lines in the buffer.
        words: number of words that these lines take.
        full: True if enough lines are ahead (I17, I16).
    """

    def __init__(self, size: int, variables: list[float]) -> None:
        self.size = size
        self._variables = variables
        self.lines: deque[Line] = deque()
        self.words = 0
        self.full = False

    def append(self, line: Line) -> None:
        """Store a line.

        Raises:
            Refusal: ERR006 without room, ERR003 for words that a rotary can't hold.
        """
        if not all(map(in_rotary, line.statements)):
            raise Refusal(DATA)
        if self.words + line.words > self.size:
            raise Refusal(NO_ROOM)
        self.lines.append(line)
        self.words += line.words
        self._mark()

    def take(self) -> Line | None:
        """Remove the next line and return it; None without one."""
        if not self.lines:
            return None
        line = self.lines.popleft()
        self.words -= line.words
        self._mark()
        return line

    def clear(self) -> None:
        """Remove all lines."""
        self.lines.clear()
        self.words, self.full = 0, False

    def _mark(self) -> None:
        """Update `full`: it becomes True at I17 lines, and False below I16 lines (TSRM 46, 286)."""
        if len(self.lines) >= self._variables[17]:
            self.full = True
        elif len(self.lines) < self._variables[16]:
            self.full = False
