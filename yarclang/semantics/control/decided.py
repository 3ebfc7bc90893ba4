"""Convert the blocks that are decided at run time to steps: WHEN, CASE, LOOP, WHILE, and REPEAT or LOOP with
a register.

A block becomes steps at which branches part and meet, and at which a loop starts again. A WHILE becomes a
LOOP with its body in a WHEN. A REPEAT counts down a register that is declared for it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from yarclang.cell.model import Cell
from yarclang.decisions import Between, Constant, Register, RegisterValue, Value
from yarclang.hir import (
    Assign,
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Finish,
    Gap,
    JointMove,
    LineMove,
    Loop,
    NextPass,
    Origin,
    Step,
    When,
)
from yarclang.semantics.actions import read_when
from yarclang.semantics.control.cases import ways_of
from yarclang.semantics.control.repeats import repeats
from yarclang.semantics.control.shifting import offset_of, shift_steps
from yarclang.semantics.declared.registers import COUNTER, OFFSETS, RETURNS, SEARCHES
from yarclang.semantics.files import File, values_of
from yarclang.semantics.motions.to_hir import origin_of
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.syntax.ast import Block, Node, Statement, Word


@dataclass(frozen=True, slots=True)
class Ended:
    """The reason why the lines after a line are never reached.

    Attributes:
        why: the reason, for the message.
        help: remedy.
        returns: True if a RETURN ends the SUB; the lines after its CALL are still reached.
    """

    why: str
    help: str
    returns: bool = False


@dataclass(slots=True)
class _Around:
    """The blocks around the current line, up to the SUB that it is in.

    Attributes:
        loops: for each loop, from the outermost to the innermost, True if a branch leaves it.
        ways: number of blocks with several branches, such as WHEN and CASE.
        returned: True if a branch of these blocks leaves the SUB.
        returns: for each loop, True if it has a RETURN.
        flag: register that is 1 after a loop if a RETURN in the loop leaves the SUB; empty without one.
    """

    loops: list[bool] = field(default_factory=list)
    ways: int = 0
    returned: bool = False
    returns: list[bool] = field(default_factory=list)
    flag: str = ""


class Decided:
    """Converter of blocks that are decided at run time to steps. It also finds lines that are never reached.

    Args:
        steps: steps of the program; the new steps are appended.
        registers: registers of the program; those that REPEAT, RETURN, OFFSET and searches need are added.
        carry_out: function that carries out lines of a file.
        count: function that counts a line that is carried out, for the limits of programs.
    """

    def __init__(
        self,
        steps: list[Step],
        registers: list[Register],
        carry_out: Callable[[tuple[Node, ...], File, Scope], None],
        count: Callable[[Statement, File], None],
    ) -> None:
        self.ended: Ended | None = None
        self._told_unreachable = False
        self._steps, self._registers = steps, registers
        self._carry_out, self._count = carry_out, count
        self._around = [_Around()]

    @property
    def is_open(self) -> bool:
        """True if the current line is in a block that is decided at run time: a STOP then ends only its own
        branch.
        """
        return any(one.ways or one.loops for one in self._around)

    @property
    def goes_nowhere(self) -> bool:
        """True if an unreachable line of the current branch was already reported."""
        return self._told_unreachable

    def end(self, ended: Ended) -> None:
        """Mark the following lines of this branch as unreachable."""
        self.ended = ended

    def tell_unreachable(self, statement: Statement, file: File) -> None:
        """Warn about a line that isn't reached, if it is the first such line of its branch."""
        # without its END, a block doesn't say which lines belong to it
        is_whole = not any(one.code == "Y0113" for one in file.findings.found)
        if not self._told_unreachable and self.ended is not None and is_whole:
            message = f"this is never reached: {self.ended.why}"
            file.findings.add("Y1001", message, statement.head_span, self.ended.help)
        self._told_unreachable = True

    @contextmanager
    def called(self, origin: Callable[[], Origin]) -> Iterator[None]:
        """Enter a SUB. A RETURN in it jumps to the end of the SUB, and its lines can't leave the loops around
        the CALL.

        Args:
            origin: function that returns the origin of the CALL (its place in the source).
        """
        begin = len(self._steps)
        self._around.append(_Around())
        try:
            yield
        finally:
            around = self._around.pop()
            if around.returned:  # a branch leaves the SUB early: write the SUB as a loop of one pass
                self._steps.insert(begin, Loop(origin()))
                self._steps.append(EndLoop(origin()))
            if around.flag:
                self._steps.insert(begin, Assign(origin(), around.flag, Constant(0.0)))
            if around.returned or (self.ended is not None and self.ended.returns):
                self._goes_on()

    def leave(self, statement: Statement, file: File, step: Exit) -> None:
        """Carry out an EXIT or a RETURN."""
        around, word = self._around[-1], step.origin.name
        returns, name = word == "RETURN", step.origin.label or word
        fault = None
        if returns and len(self._around) == 1:
            fault = "RETURN is not in a SUB", "STOP ends the program"
        elif not returns and not around.loops:
            fault = "EXIT is not in a LOOP or WHILE", "STOP ends the program, RETURN a SUB"
        if fault is not None:
            file.findings.add("Y0450", fault[0], statement.head_span, fault[1])
            self._steps.append(Gap())
            return
        if returns and around.loops:
            around.flag = around.flag or self._own_register(RETURNS, 0, 1).name
            around.returns[-1] = True
            self._steps.append(Assign(step.origin, around.flag, Constant(1.0)))
        if not returns or around.ways or around.loops:
            self._steps.append(step)
        if around.loops:
            around.loops[-1] = True
        else:
            around.returned |= returns and around.ways > 0
        what = "the SUB" if returns else "the loop"
        # A RETURN in a loop only leaves the loop: it becomes an EXIT, after the flag is set. Steps after the
        # loop then leave the SUB if the flag is set.
        leaves_all = returns and not around.loops
        self.ended = Ended(
            f"{name} has already left {what}",
            f"move {word} after this line, or into a WHEN",
            returns=leaves_all,
        )

    def _open_loop(self, left: bool) -> None:
        """Enter a loop; `left` is True if it is already known that an EXIT or RETURN leaves the loop."""
        self._around[-1].loops.append(left)
        self._around[-1].returns.append(False)

    def _close_loop(self, origin: Origin) -> bool:
        """Leave a loop. If a RETURN in it leaves the SUB, write the steps that jump from the loop's end to
        the end of the SUB.

        Returns:
            True if a branch leaves the loop.
        """
        around = self._around[-1]
        is_left, returns = around.loops.pop(), around.returns.pop()
        if returns:
            self._steps += [
                When(origin, Between("=", RegisterValue(around.flag), Constant(1.0))),
                Exit(replace(origin, name="RETURN")),
                EndWhen(origin),
            ]
            if around.loops:
                around.loops[-1] = around.returns[-1] = True
            else:
                around.returned = True
        return is_left

    def when(self, block: Block, file: File, scope: Scope) -> None:
        """Carry out a WHEN."""
        when = read_when(block.head, scope, file.findings)
        if when is None:
            self._steps.append(Gap())
            return
        around = when.origin.place
        self._steps.append(when)
        self._count(block.head, file)
        with self._parted():
            self._carry_out(block.body, file, Scope(scope))
            ended = [self._way_ended()]
            if block.otherwise is not None:
                head = block.otherwise_head or block.head
                self._steps.append(Else(_origin(head, "ELSE", file, around)))
                self._carry_out(block.otherwise, file, Scope(scope))
            ended.append(self._way_ended())
        self._meet(ended)
        self._steps.append(EndWhen(_origin(block.end or block.head, "END", file, around)))

    def wait(self, block: Block, file: File, scope: Scope, when: When | None) -> None:
        """Carry out a WAIT with its ELSE.

        It becomes a WHEN whose first branch is empty. The WHEN is decided as soon as the condition is true or
        the time is over.
        """
        if when is None:
            self._steps.append(Gap())
            return
        around = when.origin.place
        self._steps += [when, Else(replace(when.origin, name="ELSE"))]
        self._count(block.head, file)
        with self._parted():
            self._carry_out(block.otherwise or (), file, Scope(scope))
            self._way_ended()
        self._steps.append(EndWhen(_origin(block.end or block.head, "END", file, around)))

    def search(self, step: JointMove | LineMove, otherwise: Callable[[], None] | None, end: Origin) -> None:
        """Write a motion with UNTIL (a search), and the steps that are taken if its input isn't found.

        Args:
            step: the motion, with its search.
            otherwise: function that carries out the lines of its ELSE; None: the run ends if the input isn't
                found.
            end: origin of the END.
        """
        assert step.search is not None
        flag = self._own_register(SEARCHES, 0, 1).name
        origin = step.origin
        self._steps += [
            Assign(origin, flag, Constant(0.0)),
            replace(step, search=replace(step.search, flag=flag)),
            When(origin, Between("=", RegisterValue(flag), Constant(1.0))),
            Else(replace(origin, name="ELSE")),
        ]
        if otherwise is None:
            state = {0.0: "OFF", 1.0: "ON"}.get(step.search.value, f"{step.search.value:g}")
            why = f"{step.search.name} was not {state} up to the end of {origin.label or origin.name}"
            self._steps.append(Finish(origin, fails=True, text=why))
        else:
            with self._parted():
                otherwise()
                self._way_ended()
        self._steps.append(EndWhen(end))

    def offset(self, block: Block, file: File, scope: Scope, cell: Cell | None) -> None:
        """Carry out an OFFSET, which becomes a WHEN.

        The condition of the WHEN is that the lines can be carried out with the shifted frame. If they can't
        and there is no ELSE, a run holds and shows the reason, and a controller text that runs without the
        streaming runtime ends.
        """
        around, begin = file.findings.place, len(self._steps)
        flag = self._own_register(OFFSETS, 0, 1).name
        shifted = offset_of(block.head, scope, cell, flag, file.findings)
        if shifted is None:
            self._steps.append(Gap())
            return
        origin = _origin(block.head, "OFFSET", file, around)
        condition = Between("=", RegisterValue(flag), Constant(1.0))
        self._steps.append(When(origin, condition, offset=shifted))
        self._count(block.head, file)
        with self._parted():
            self._carry_out(block.body, file, Scope(scope))
            ended = [self._way_ended()]
            shift_steps(self._steps, begin, file.findings)
            self._steps.append(Else(_origin(block.otherwise_head or block.head, "ELSE", file, around)))
            if block.otherwise is None:
                why = f"what is given in {{{shifted.name}}} can't be carried out where it is"
                self._steps.append(Finish(origin, fails=True, text=why))
                self.end(Ended(why, "write an ELSE"))
            else:
                self._carry_out(block.otherwise, file, Scope(scope))
            ended.append(self._way_ended())
        self._meet(ended)
        self._steps.append(EndWhen(_origin(block.end or block.head, "END", file, around)))

    def case(self, block: Block, file: File, scope: Scope) -> None:
        """Carry out a CASE.

        Each OF becomes a WHEN in the ELSE of the previous WHEN. The value of the CASE is read once, at the
        first WHEN. All these WHENs use this value.
        """
        ways, around = ways_of(block, scope, file.findings), file.findings.place
        if ways is None:
            self._steps.append(Gap())
            return
        opened = 0
        ended: list[Ended | None] = []
        with self._parted():
            for way in ways:
                self._count(way.of, file)
                if opened:
                    self._steps.append(Else(_origin(way.of, "ELSE", file, around)))
                if way.condition is not None:
                    self._steps.append(
                        When(_origin(way.of, "OF", file, around), way.condition, again=opened > 0)
                    )
                    opened += 1
                self._carry_out(tuple(way.nodes), file, Scope(scope))
                ended.append(self._way_ended())
            if block.otherwise is not None:
                self._steps.append(Else(_origin(block.otherwise_head or block.head, "ELSE", file, around)))
                self._carry_out(block.otherwise, file, Scope(scope))
                ended.append(self._way_ended())
        self._meet(ended)
        self._steps += [EndWhen(_origin(block.end or block.head, "END", file, around))] * opened

    def loop(self, block: Block, file: File, scope: Scope) -> None:
        """Carry out a LOOP up to its END or UNTIL. A LOOP with a number makes at most that many passes."""
        refuse_parts(block.head, NOT_FOR_BLOCKS, file.findings)
        if values_of(block.head):
            self._times(block, file, scope)
            return
        around, end = file.findings.place, block.end or block.head
        self._steps.append(Loop(_origin(block.head, "LOOP", file, around)))
        self._count(block.head, file)
        self._open_loop(left=False)
        self._carry_out(block.body, file, Scope(scope))
        if end.name.name == "UNTIL" and self.ended is None:
            file.findings.place = around
            until = read_when(end, scope, file.findings)
            self._around[-1].loops[-1] = True
            if until is None:
                self._steps.append(Gap())
            else:
                self._count(end, file)
                self._steps += [until, Exit(until.origin), EndWhen(until.origin)]
        origin = _origin(end, end.name.name, file, around)
        if self.ended is None:
            self._steps.append(NextPass(origin))
            why = f"the LOOP of line {block.head.line} never ends"
            self.ended = Ended(why, "write UNTIL instead of END, or EXIT in a WHEN")
        self._steps.append(EndLoop(origin))
        if self._close_loop(origin):
            self._goes_on()

    def _times(self, block: Block, file: File, scope: Scope) -> None:
        """Carry out a LOOP that makes at most a given number of passes."""
        head, values, end = block.head, values_of(block.head), block.end
        word = values[0] if len(values) == 1 and isinstance(values[0], Word) else None
        register = None if word is None else scope.name(word.name)
        if isinstance(register, Register):
            self.repeat(block, file, scope, RegisterValue(register.name), register)
            return
        if end is not None and end.name.name == "UNTIL":
            message = "a LOOP with a number of passes must end with END, not UNTIL"
            file.findings.add("Y0401", message, end.head_span, "to leave it earlier, write EXIT in a WHEN")
            self._steps.append(Gap())
            return
        count = repeats(head, values, scope, file.findings)
        if count is None:
            self._steps.append(Gap())
            return
        self.repeat(block, file, scope, Constant(float(count)), Register("", 0, count, 0))

    def while_(self, block: Block, file: File, scope: Scope) -> None:
        """Carry out a WHILE: a loop with its body in a WHEN."""
        around = file.findings.place
        when = read_when(block.head, scope, file.findings)
        if when is None:
            self._steps.append(Gap())
            return
        self._count(block.head, file)
        self._looped(block, file, scope, [when], _origin(block.end or block.head, "END", file, around))

    def repeat(self, block: Block, file: File, scope: Scope, count: Value, bounds: Register) -> None:
        """Carry out a REPEAT or LOOP whose passes are counted at run time.

        Args:
            block: the loop.
            file: file of the loop.
            scope: the names in scope at the loop.
            count: number of passes.
            bounds: a register whose range contains every possible number of passes.
        """
        head, around = block.head, file.findings.place
        origin = _origin(head, head.name.name, file, around)
        end = _origin(block.end or head, "END", file, around)
        own = self._own_register(COUNTER, min(bounds.low, 0), max(bounds.high, 0), scope)
        self._count(head, file)
        left = RegisterValue(own.name)
        self._steps.append(Assign(origin, own.name, count))
        counts = Assign(origin, own.name, Between("-", left, Constant(1.0)))
        self._looped(block, file, scope, [When(origin, Between(">", left, Constant(0.0))), counts], end)

    def _looped(self, block: Block, file: File, scope: Scope, begin: list[Step], end: Origin) -> None:
        """Convert a loop whose condition is at its head to steps.

        Args:
            block: the loop.
            file: file of the loop.
            scope: the names in scope at the loop.
            begin: the WHEN that leads into the body, and the first steps of the body.
            end: origin of the END.
        """
        (when, *_) = begin
        assert isinstance(when, When)
        self._steps += [Loop(when.origin), *begin]
        self._open_loop(left=True)
        with self._parted():
            self._carry_out(block.body, file, Scope(scope))
            if self._way_ended() is None:
                self._steps.append(NextPass(end))
        self._steps += [EndWhen(end), EndLoop(end)]
        self._close_loop(end)

    def _own_register(self, word: str, low: int, high: int, scope: Scope | None = None) -> Register:
        """Declare a register for a block. Its name is `word` and a number, and isn't in use yet."""
        taken = {one.name for one in self._registers}
        number = next(
            number
            for number in range(1, len(taken) + 2)
            if f"{word}{number}" not in taken and (scope is None or scope.name(f"{word}{number}") is None)
        )
        own = Register(f"{word}{number}", low, high, 0)
        self._registers.append(own)
        return own

    @contextmanager
    def _parted(self) -> Iterator[None]:
        around = self._around[-1]
        around.ways += 1
        yield
        around.ways -= 1

    def _way_ended(self) -> Ended | None:
        """Return the reason why the branch that has just been carried out doesn't reach its end (None if it
        does), and mark the next branch as reachable.
        """
        ended = self.ended
        self._goes_on()
        return ended

    def _goes_on(self) -> None:
        self.ended, self._told_unreachable = None, False

    def _meet(self, ended: list[Ended | None]) -> None:
        """Continue after the branches of a block. If no branch reaches its end, the lines that follow are
        unreachable.

        Args:
            ended: for each branch, the reason why it doesn't reach its end; None if it does.
        """
        if all(one is not None for one in ended):
            self.ended = ended[-1]


def _origin(statement: Statement, word: str, file: File, around: str) -> Origin:
    """Return the origin of a step that stands for a block, such as a WHEN. The origin has the place of the
    block, not that of a line in it.
    """
    return replace(origin_of(statement, word, file.findings), place=around)
