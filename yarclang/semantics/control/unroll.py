"""Carry out loops, conditions and calls at compile time: convert the blocks of a file to a flat list of
steps.

Every command has a place: the calls and loops around it, such as `P0020(I=2)>P0010`. The commands of a loop
or a call are counted in advance (counting.py). In a program with errors, and for a quick check, only a
limited number of lines of loops and calls is carried out (extent.py).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from yarclang.cell.keeping import Keep
from yarclang.cell.model import Cell
from yarclang.commands.registry import actions
from yarclang.decisions import Register, RegisterValue, Watch
from yarclang.diagnostics import Diagnostic, has_errors
from yarclang.hir import (
    Array,
    Exit,
    Finish,
    Gap,
    JointMove,
    LineMove,
    Motion,
    Output,
    Say,
    Step,
    Stop,
    WayOut,
)
from yarclang.memory import Forgetful
from yarclang.semantics.actions import (
    assigns,
    read_action,
    read_assignment,
    read_wait,
    read_wait_else,
)
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.control.arguments import name_arguments, said_of_time
from yarclang.semantics.control.calling import Calls
from yarclang.semantics.control.conditional import KnownBehind
from yarclang.semantics.control.counting import (
    DEEPEST,
    Count,
    Counter,
    TooMuch,
    Uncounted,
    too_deep,
    too_much_so_far,
)
from yarclang.semantics.control.decided import Decided, Ended
from yarclang.semantics.control.extent import ENOUGH_WITH_ERRORS, Extent
from yarclang.semantics.control.keeping import keep_of
from yarclang.semantics.control.places import Place, at, index_of, looped, shown
from yarclang.semantics.control.repeats import counted, repeats
from yarclang.semantics.declared.declaring import Declaring
from yarclang.semantics.declared.meanings import may_be_declared
from yarclang.semantics.declared.watching import check_way_out
from yarclang.semantics.files import File, Sub
from yarclang.semantics.motions.to_hir import origin_of, to_step
from yarclang.semantics.names.commands import CommandNames, ResolvedName
from yarclang.semantics.names.scope import Scope, Where
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.semantics.recalling import step_before
from yarclang.semantics.values.amounts import Amount
from yarclang.semantics.values.evaluate import EvaluationError, evaluate
from yarclang.syntax.ast import Block, Module, Node, Statement, Text
from yarclang.syntax.words import DECLARATIONS


@dataclass(slots=True)
class Unrolled:
    """The result of carrying out a program's loops, conditions and calls.

    Attributes:
        steps: the steps.
        start: (n,) [rad or m] joint position of the START line; None without one.
        outputs: declared outputs.
        cell: the cell around the robot; None without one.
        findings: the findings of all files.
        is_cut: True if some rounds of loops or some calls were not carried out.
        registers: declared registers, and the registers that loops and searches use.
        watches: inputs that hold the motion.
        ways_out: the motions by which the robot withdraws after such an input has held the motion.
    """

    steps: list[Step]
    start: Array | None
    outputs: list[Output]
    cell: Cell | None
    findings: list[Diagnostic]
    is_cut: bool
    registers: list[Register]
    watches: list[Watch]
    ways_out: list[WayOut]


def unroll(module: Module, context: Context) -> Unrolled:
    """Carry out a program's declarations, loops, conditions and calls.

    A long program is first carried out up to a limit, because most errors appear there already. It is carried
    out completely only if none has appeared.
    """
    least = context.enough or ENOUGH_WITH_ERRORS
    unrolled = _Unroller(context, least).program(module)
    if not unrolled.is_cut or context.enough is not None or has_errors(unrolled.findings):
        return unrolled
    return _Unroller(context, None).program(module)


def declared_names(module: Module, context: Context) -> Scope:
    """Return the names that a file declares outside of blocks, including its SUBs, without findings.

    Nothing else is carried out. Tools use this to show the meaning of a name in a program that may have
    errors.
    """
    declaring = Declaring(context, CommandNames(context.profiles), [])
    file = declaring.file(module, is_program=True)
    declaring.begin(file)
    for node in declaring.arranged(module, file):
        word = node.head.name.name if isinstance(node, Block) else node.name.name
        if word == "SUB" or (isinstance(node, Statement) and node.index is None and word in DECLARATIONS):
            declaring.declare_only(node, file)
    return file.scope


_NO_COMMANDS = DECLARATIONS - {"WHEN", "OF", "LOOP", "WHILE", "UNTIL", "OFFSET"}
"""Words of lines that don't count as commands."""


class _Unroller:
    """One run through a program.

    Args:
        context: inputs besides the text.
        enough: number of lines in loops and SUBs that are carried out; None: all.
    """

    def __init__(self, context: Context, enough: int | None) -> None:
        self._context = context
        self._steps: list[Step] = []
        self._names = CommandNames(context.profiles)
        self._declaring = Declaring(context, self._names, self._steps)
        self._calls = Calls()
        self._behind = KnownBehind()
        self._counter = Counter(context.enough)
        self._extent = Extent(self._declaring.collectors, enough)
        self._shown_once: set[Sub] = set()
        """SUBs that were called after the limit of lines was reached."""
        self._commands = 0
        self._counted = Count()
        """Commands, lines and rounds from the beginning to the current line. Loops and calls are counted in
        advance.
        """
        self._depth = 0
        """Number of blocks and calls that are being carried out."""
        self._decided = Decided(self._steps, self._declaring.registers, self._carry_out, self._count_way)
        self._place: Place = ()
        """Place of the block that is being carried out."""
        self._keeps: tuple[Keep, ...] = ()
        self._kept_around: list[tuple[Keep, Block]] = []
        """The rules of all KEEPs around the lines that are being carried out."""
        self._is_too_much = False
        self._ways_out: list[WayOut] = []

    def program(self, module: Module) -> Unrolled:
        """Carry out the whole program."""
        declaring, cells = self._declaring, self._declaring.cells
        file = declaring.file(module, is_program=True)
        declaring.begin(file)
        nodes = declaring.arranged(module, file)
        if module.unreadable_lines:
            self._extent.expect_syntax_errors()
        self._nodes(nodes, file, file.scope, ())
        if module.unreadable_lines:
            self._steps.append(Gap())
        if cells.broken or self._is_too_much:
            self._steps[:] = [Gap()]  # there is no use in planning an incomplete program
        found = [one for collector in declaring.collectors for one in collector.found]
        told = cells.without_followers(found)
        return Unrolled(
            self._steps,
            declaring.start,
            declaring.outputs,
            cells.cell,
            told,
            self._extent.is_reached,
            declaring.registers,
            declaring.watches,
            self._ways_out,
        )

    def _nodes(self, nodes: tuple[Node, ...], file: File, scope: Scope, place: Place) -> None:
        where, source = shown(place), file.findings.source
        for node in nodes:
            file.findings.place = where
            head = node.head if isinstance(node, Block) else node
            size = self._counter.size(head, source)
            self._extent.add(size, again=bool(place))
            if not place and head.name.name not in (
                "REPEAT",
                "CALL",
            ):  # REPEAT and CALL are counted together with their lines
                is_command = head.index is not None or head.name.name not in _NO_COMMANDS
                self._add_counted(Count(int(is_command), size), head, file)
            if isinstance(node, Block) and self._decided.ended is not None and node.head.name.name != "SUB":
                self._decided.tell_unreachable(node.head, file)
            elif isinstance(node, Block):
                self._block(node, file, scope, place)
            elif node.index is None and node.name.name in DECLARATIONS:
                watches = len(self._declaring.watches)
                self._declaring.declare(node, file, scope)
                for watch in self._declaring.watches[watches:]:
                    self._way_out(node, watch.then, file, scope)
            else:
                self._command(node, file, scope, place)

    def _block(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        self._depth += 1
        before, self._place = self._place, place
        match block.head.name.name:
            case "SUB":
                self._declaring.declare_sub(block, file, scope)
            case "REPEAT":
                self._repeat(block, file, scope, place)
            case "IF":
                self._if(block, file, scope, place)
            case "CASE":
                self._decided.case(block, file, scope)
            case "WAIT":
                self._wait(block, file, scope, place)
            case "OFFSET":
                self._decided.offset(block, file, scope, self._declaring.cells.cell)
            case "KEEP":
                self._keep(block, file, scope, place)
            case _ if block.head.waits_else:
                self._search(block, file, scope, place)
            case "LOOP":
                self._decided.loop(block, file, scope)
            case "WHILE":
                self._decided.while_(block, file, scope)
            case _:
                self._decided.when(block, file, scope)
        self._depth -= 1
        self._place = before

    def _keep(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        """Carry out the lines of a KEEP block. All motions among them must obey its rule, including the
        motions of CALLs.
        """
        kept = keep_of(block.head, scope, file.defaults, file.findings)
        if kept is None:
            self._steps.append(Gap())
            return
        before, begin = self._keeps, len(self._steps)
        around = [one for one, other in self._kept_around if _is_inside(block, other)]
        if wider := next((one for one in around if kept.is_within(one)), None):
            message = f"KEEP {kept.words} has no effect: KEEP {wider.words} around it is at least as strict"
            help_ = "give it a narrower limit, or remove this KEEP and its END"
            file.findings.add("Y0483", message, block.head.whole_span, help_)
        self._kept_around.append((kept, block))
        if kept not in before:
            self._keeps = (*before, kept)
        self._nodes(block.body, file, Scope(scope), place)
        self._keeps = before
        self._kept_around.pop()
        if not any(isinstance(one, Motion | Gap) for one in self._steps[begin:]):
            message = "no line of this KEEP moves the robot"
            help_ = "move the motions between KEEP and its END"
            file.findings.add("Y0481", message, block.head.whole_span, help_)

    def _wait(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        """Carry out a WAIT that has an ELSE."""
        file.command_seen = True
        file.findings.place = shown(at(place, block.head)) if place else ""
        step = read_wait_else(block.head, scope, file.defaults, file.findings)
        self._decided.wait(block, file, scope, step)

    def _search(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        """Carry out a motion with UNTIL and ELSE."""
        file.command_seen = True
        self._count_command(block.head, file)
        file.findings.place = shown(at(place, block.head)) if place else ""
        name = self._names.resolved(block.head, file.findings)
        step = None if name is None else self._read(block.head, name, file, scope, is_alone=not place)
        if not isinstance(step, JointMove | LineMove) or step.search is None:
            self._steps.append(Gap())
            return
        if self._is_typed(block.head, file):
            return
        end = block.end or block.head
        origin = replace(origin_of(end, "END", file.findings), place=file.findings.place)
        self._decided.search(step, lambda: self._carry_out(block.otherwise or (), file, Scope(scope)), origin)

    def _is_typed(self, statement: Statement, file: File) -> bool:
        """Return True, with a finding, if a motion with UNTIL was typed in the live interpreter, where the
        lines that must follow it are missing.
        """
        if self._context.index_needed:
            return False
        until = next(one for one in statement.options if one.word.name == "UNTIL")
        message = "UNTIL works only in a file: each typed line is carried out by itself"
        file.findings.add(
            "Y0208",
            message,
            statement.span(until.word.place),
            "write the lines into a file, and run the file",
        )
        self._steps.append(Gap())
        return True

    def _carry_out(self, nodes: tuple[Node, ...], file: File, scope: Scope) -> None:
        """Carry out lines of a block that is decided at run time."""
        place = self._place
        self._nodes(nodes, file, scope, place)
        self._place = place

    def _count_way(self, statement: Statement, file: File) -> None:
        """Count the line of a WHEN, OF, LOOP, WHILE, UNTIL or REPEAT that is carried out."""
        self._count_command(statement, file)
        if not self._place and statement.name.name in ("OF", "UNTIL"):
            size = self._counter.size(statement, file.findings.source)
            self._add_counted(Count(1, size), statement, file)

    def _if(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        head = block.head
        assert head.expression is not None
        try:
            holds = bool(evaluate(head.expression, scope).value)
        except EvaluationError as error:
            file.findings.add_error(error, head.span(error.place))
            self._steps.append(Gap())
            return
        chosen = block.body if holds else (block.otherwise or ())
        inner = Scope(scope)
        self._nodes(chosen, file, inner, place)
        scope.take_over(inner, self._behind.of(block))

    def _repeat(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        head = block.head
        refuse_parts(head, NOT_FOR_BLOCKS, file.findings)
        word, values = counted(head)
        register = None if word is None or values else scope.name(word.name)
        if isinstance(register, Register):
            self._count(block, file, scope, place)
            self._decided.repeat(block, file, scope, RegisterValue(register.name), register)
            return
        count = repeats(head, values, scope, file.findings)
        if word is not None and not may_be_declared(head, word, scope, self._context.robot, file.findings):
            word = None
        if count is None:
            self._steps.append(Gap())
            return
        self._count(block, file, scope, place)
        where = None if word is None else Where(file.findings.source, head.span(word.place))
        for number in range(count):
            inner = Scope(scope)
            if word is not None:
                inner.declare(word.name, Amount(float(number)), where)
            label = f"{word.name}={number}" if word is not None else f"#{number}"
            before = self._commands
            self._nodes(block.body, file, inner, looped(place, label))
            if self._commands == before:
                self._count_command(head, file)  # the rounds of an empty loop count as commands, too
                self._extent.add(1, again=True)
            if self._decided.goes_nowhere:
                break
            if self._extent.is_reached and number + 1 < count:
                self._steps.append(Gap())
                break

    def _count(self, node: Node, file: File, scope: Scope, place: Place) -> None:
        """Count the commands of a loop or call that isn't inside another loop or SUB; add a finding if a
        limit is exceeded.
        """
        if place or self._is_too_much or self._decided.ended is not None:
            return
        head = node.head if isinstance(node, Block) else node
        try:
            count = self._counter.count(node, file, scope, self._depth)
        except TooMuch as error:
            # If the line is outside of this block, the finding names the loop or CALL that leads to the line.
            is_own = error.file is file and head.line <= error.statement.line <= _last_line(node)
            self._tell_too_much(error, "" if is_own else index_of(head))
            return
        except Uncounted:
            return
        self._extent.expect(count.lines)
        self._add_counted(count, head, file)

    def _add_counted(self, count: Count, statement: Statement, file: File) -> None:
        """Add the commands, lines and rounds of a line outside of loops and SUBs to the total; add a finding
        if the program exceeds a limit.
        """
        self._counted += count
        error = None if self._is_too_much else too_much_so_far(file, statement, self._counted)
        if error is not None:
            self._tell_too_much(error)

    def _tell_too_much(self, error: TooMuch, place: str = "") -> None:
        """Add the finding that a program exceeds a limit, and carry out as little as possible of the rest."""
        findings = error.file.findings
        before, findings.place = findings.place, place
        findings.add_error(error, error.statement.whole_span)
        findings.place = before
        self._is_too_much = True
        self._extent.reach()

    def _call(
        self, statement: Statement, file: File, scope: Scope, place: Place, within: Place | None = None
    ) -> None:
        """Carry out the SUB of a CALL.

        Args:
            statement: the CALL.
            file: the file of the CALL.
            scope: the names in scope at the CALL.
            place: place of the block with the CALL.
            within: place for the commands of the SUB; None: the place of the CALL.
        """
        findings = file.findings
        findings.place = shown(at(place, statement)) if place else ""
        refuse_parts(statement, NOT_FOR_BLOCKS, findings)
        self._count(statement, file, scope, place)
        begun = self._calls.begin(statement, file, scope)
        if begun is None:
            self._steps.append(Gap())
            return
        sub, inner = begun
        try:
            if self._is_left_out(sub, statement, file):
                self._steps.append(Gap())
            else:
                self._depth += 1
                where = findings.place
                with self._decided.called(
                    lambda: replace(origin_of(statement, "CALL", findings), place=where)
                ):
                    self._nodes(sub.block.body, sub.file, inner, within or (*at(place, statement), ""))
                self._depth -= 1
        finally:
            self._calls.end()

    def _way_out(self, statement: Statement, name: str, file: File, scope: Scope) -> None:
        """Carry out the SUB that an ON calls, once for all inputs that call it. Its commands don't become
        steps of the program.

        Args:
            statement: the ON.
            name: the SUB; empty if the ON calls none.
            file: the file of the ON.
            scope: the names in scope at the ON.
        """
        if not name or any(one.name == name for one in self._ways_out):
            return
        (head,) = statement.waypoints
        called = replace(
            statement,
            name=replace(statement.name, text="CALL"),
            waypoints=(replace(head, values=head.values[3:]),),
        )
        begin, seen = len(self._steps), file.command_seen
        self._call(called, file, scope, (), within=(name, ""))
        file.command_seen = seen
        steps = tuple(self._steps[begin:])
        del self._steps[begin:]
        self._decided.ended = None
        if not check_way_out(steps, name, statement.whole_span, file.findings):
            self._steps.append(Gap())
            return
        self._ways_out.append(WayOut(name, origin_of(statement, "ON", file.findings), steps))

    def _is_left_out(self, sub: Sub, statement: Statement, file: File) -> bool:
        """Return True if a SUB isn't carried out because the limit on lines is reached or because it is
        nested too deep.
        """
        if self._depth >= DEEPEST:
            if not self._is_too_much:
                self._tell_too_much(too_deep(file, statement), file.findings.place)
            return True
        if self._extent.is_reached:
            if sub in self._shown_once:
                return True
            self._shown_once.add(sub)
        return False

    def _command(self, statement: Statement, file: File, scope: Scope, place: Place) -> None:
        file.command_seen = True
        self._count_command(statement, file)
        if self._decided.ended is not None:
            self._decided.tell_unreachable(statement, file)
            return
        word = statement.name.name
        if word == "CALL":
            self._call(statement, file, scope, place)
            return
        file.findings.place = shown(at(place, statement)) if place else ""
        given, before = self._calls.given, len(file.findings.found)
        if word == "SET" and assigns(statement, scope):
            assigned = read_assignment(statement, scope, file.findings)
            steps: tuple[Step, ...] = () if assigned is None else (assigned,)
        elif word == "WAIT" and statement.expression is not None:
            waits = read_wait(statement, scope, file.defaults, file.findings)
            steps = () if waits is None else (waits,)
        elif (action := actions().get(word)) is not None:
            steps = read_action(statement, action, scope, file.defaults, file.findings) or ()
            if any(isinstance(one, Say) and one.teaches for one in steps) and not self._context.index_needed:
                message = f"{statement.name.name} works only in a file, which its taught places belong to"
                file.findings.add(
                    "Y0208", message, statement.head_span, "write the lines into a file, and run the file"
                )
                steps = ()
        else:
            name = self._names.resolved(statement, file.findings)
            step = None if name is None else self._read(statement, name, file, scope, is_alone=not place)
            steps = () if step is None else (step,)
        if steps and isinstance(steps[0], Exit):
            self._decided.leave(statement, file, steps[0])
            return
        if any(isinstance(step, Stop) for step in steps) and self._decided.is_open:
            steps = tuple(Finish(step.origin) if isinstance(step, Stop) else step for step in steps)
        if given:
            name_arguments(statement, file.findings, before, given)
            if told := said_of_time(statement.time, given):
                steps = tuple(
                    step
                    if isinstance(step, Gap)
                    else replace(step, origin=replace(step.origin, time_given=told))
                    for step in steps
                )
        for step in steps or (Gap(),):
            if isinstance(step, JointMove | LineMove) and step.search is not None:
                if self._is_typed(statement, file):
                    return
                self._decided.search(step, None, replace(step.origin, name="END"))
                continue
            self._steps.append(step)
            if isinstance(step, Stop | Finish):
                why = f"{step.origin.label or step.origin.name} ends the program"
                self._decided.end(Ended(why, f"move {step.origin.name} to the end, or remove it"))

    def _read(
        self, statement: Statement, name: ResolvedName, file: File, scope: Scope, *, is_alone: bool
    ) -> Step | None:
        """Return the step of a motion command; None with findings if it has an error.

        Args:
            statement: the command.
            name: its resolved name.
            file: its file.
            scope: the names in scope at the command.
            is_alone: True outside of loops and SUBs; the step is then cached.
        """
        context, findings = self._context, file.findings

        def make(defaults: Defaults, names: Scope) -> Step | None:
            return to_step(statement, name, context, defaults, names, findings)

        # Don't cache: the cache's key is the text of the command, and a trajectory file isn't part of this
        # text.
        if not is_alone or isinstance(context.memory, Forgetful) or _names_file(statement):
            step = make(file.defaults, scope)
        else:
            step = step_before(context.memory, context.robot, statement, file.defaults, scope, findings, make)
        return replace(step, keeps=self._keeps) if self._keeps and isinstance(step, Motion) else step

    def _count_command(self, statement: Statement, file: File) -> None:
        """Count a command that is carried out.

        The limit was checked in advance, with lines with mistakes counted as nothing. Only such lines can
        therefore cause a finding here.
        """
        self._commands += 1
        error = None if self._is_too_much else too_much_so_far(file, statement, Count(self._commands))
        if error is not None:
            self._tell_too_much(error)


def _is_inside(block: Block, other: Block) -> bool:
    """Return True if a block is written inside another one. The lines of a SUB that the other block calls
    don't count.
    """
    return any(one is block or (isinstance(one, Block) and _is_inside(block, one)) for one in other.body)


def _names_file(statement: Statement) -> bool:
    """Return True if a command names a trajectory file (a text in quotes) instead of waypoints."""
    return len(statement.waypoints) == 1 and isinstance(statement.waypoints[0].values[0], Text)


def _last_line(node: Node) -> int:
    """Return the number of the last line of a statement or block."""
    if isinstance(node, Statement):
        return node.line + node.rows - 1
    last = node.end or (*node.body, *(node.otherwise or ()), node.head)[-1]
    return last.line if isinstance(last, Statement) else _last_line(last)
