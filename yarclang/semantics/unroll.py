"""Loops, conditions and calls carried out: a file's blocks to a flat list of steps.

Every command knows its place: what led to it, from outside in, as `P0020(I=2)>P0010`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector, Diagnostic, suggest
from yarclang.hir import Array, Else, EndWhen, Gap, Output, Step, Stop
from yarclang.memory import Forgetful
from yarclang.robot.model import Robot
from yarclang.semantics.actions import ACTIONS, read_action, read_when
from yarclang.semantics.amounts import Amount
from yarclang.semantics.arguments import Given, name_arguments, said_of_time
from yarclang.semantics.cells import Cells
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.declarations import check_robot, read_default, read_start
from yarclang.semantics.evaluate import EvaluationError, evaluate
from yarclang.semantics.indices import check_indices, commands_of
from yarclang.semantics.names import ResolvedName, resolve_name
from yarclang.semantics.naming import (
    declare_frame,
    declare_joints,
    declare_number,
    declare_signal,
    may_be_declared,
)
from yarclang.semantics.parameters import bind, check_parameters, given_by
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.recalling import step_before
from yarclang.semantics.scope import (
    KINDS,
    Library,
    Routine,
    Scope,
    Where,
)
from yarclang.semantics.signals import Signals
from yarclang.semantics.to_hir import origin_of, to_step
from yarclang.semantics.units import amount, number_fault
from yarclang.source import Span
from yarclang.syntax.ast import (
    Block,
    Computed,
    Module,
    Node,
    Number,
    Parameter,
    Statement,
    Value,
    Word,
)
from yarclang.syntax.blocks import arrange
from yarclang.syntax.words import DECLARATIONS

MOST_COMMANDS = 1_000_000
"""Unrolled commands of a program."""

_AT_THE_TOP = ("ROBOT", "CELL", "USE", "DEFAULT", "START")
"""Declarations that stand before the first command."""

_ONCE = ("ROBOT", "CELL", "DEFAULT", "START")


_NOT_FOR_BLOCKS = ("a moving frame", "a motion time", "units", "a base frame", "options")


class TooManyCommands(Exception):  # noqa: N818 - ends the unrolling, and is told as a finding
    """The program is longer than is ever planned."""


@dataclass(slots=True, eq=False)
class Sub:
    """A SUB: its text, what its file had declared before it, and that file's defaults and findings."""

    block: Block
    scope: Scope
    file: File

    @property
    def name(self) -> str:
        """Its name in upper case."""
        return _values(self.block.head)[0].text.upper()


@dataclass(slots=True, eq=False)
class File:
    """A file that is being read: its names, its defaults, and who collects what is wrong with it."""

    findings: Collector
    scope: Scope
    defaults: Defaults
    is_program: bool
    seen: dict[str, int] = field(default_factory=dict)
    command_seen: bool = False


@dataclass(slots=True)
class Unrolled:
    """What comes of a file: steps, the start that it gives, its outputs, and all findings."""

    steps: list[Step]
    start: Array | None
    outputs: list[Output]
    cell: Cell | None
    findings: list[Diagnostic]


def unroll(module: Module, context: Context) -> Unrolled:
    """Carry out a program's declarations, loops, conditions and calls."""
    unroller = _Unroller(context)
    return unroller.program(module)


def declared_names(module: Module, context: Context) -> Scope:
    """What the names mean that a file declares outside of blocks, and the SUBs; what is wrong with them is left unsaid.

    Nothing else is carried out: this is for whoever shows what a name means, in a program that may have errors.
    """
    return _Unroller(context).names(module)


class _Unroller:
    def __init__(self, context: Context) -> None:
        self._context = context
        self._robot: Robot = context.robot
        self._steps: list[Step] = []
        self._outputs: list[Output] = []
        self._signals = Signals()
        self._cells = Cells(context)
        self._start: Array | None = None
        self._collectors: list[Collector] = []
        self._names: dict[tuple[int, int], ResolvedName | None] = {}
        self._files: list[File] = []  # they live as long as the keys that are made of them
        self._loading: list[str] = []
        self._modules: dict[str, Library] = {}
        self._calls: list[Sub] = []
        self._given: list[Given] = []
        self._commands = 0
        self._whens = 0
        self._ended: str | None = None
        self._told_unreachable = False

    def program(self, module: Module) -> Unrolled:
        """The whole program."""
        file = self._file(module, is_program=True)
        try:
            nodes = self._arranged(module, file)
            self._resolve_all(nodes, file)
            self._nodes(nodes, file, file.scope, ())
        except TooManyCommands:
            self._steps.clear()  # what isn't whole needn't be planned
            message = f"the program has more than {MOST_COMMANDS:,} commands when its loops are unrolled"
            file.findings.place = ""
            file.findings.add(
                "Y1004", message, Span.on_line(1, 1, 2), "make the loops shorter, or several programs"
            )
            self._steps.append(Gap())
        if module.unreadable_lines:
            self._steps.append(Gap())
        if self._cells.broken:
            self._steps[:] = [Gap()]  # poses and positions that aren't what they should be needn't be planned
        found = [one for collector in self._collectors for one in collector.found]
        return Unrolled(
            self._steps, self._start, self._outputs, self._cells.cell, self._cells.without_followers(found)
        )

    def names(self, module: Module) -> Scope:
        """The names of a file, without its commands."""
        file = self._file(module, is_program=True)
        for node in self._arranged(module, file):
            word = node.head.name.name if isinstance(node, Block) else node.name.name
            if word == "SUB" or (isinstance(node, Statement) and node.index is None and word in DECLARATIONS):
                self._module_node(node, file)
        return file.scope

    def _file(self, module: Module, *, is_program: bool) -> File:
        findings = Collector(module.source)
        self._collectors.append(findings)
        scope = Scope(Scope.of_robot(self._robot))
        file = File(findings, scope, Defaults(scope), is_program)
        self._files.append(file)
        return file

    def _arranged(self, module: Module, file: File) -> tuple[Node, ...]:
        arranged = arrange(module)
        file.findings.found += arranged.diagnostics
        assert arranged.value is not None
        if any(one.is_error for one in arranged.diagnostics):
            self._steps.append(Gap())
        return arranged.value

    # nodes

    def _nodes(self, nodes: tuple[Node, ...], file: File, scope: Scope, place: tuple[str, ...]) -> None:
        for node in nodes:
            file.findings.place = _shown(place)
            if isinstance(node, Block):
                self._block(node, file, scope, place)
            elif node.index is None and node.name.name in DECLARATIONS:
                self._declaration(node, file, scope)
            else:
                self._command(node, file, scope, place)

    def _block(self, block: Block, file: File, scope: Scope, place: tuple[str, ...]) -> None:
        match block.head.name.name:
            case "SUB":
                self._sub(block, file, scope)
            case "REPEAT":
                self._repeat(block, file, scope, place)
            case "IF":
                self._if(block, file, scope, place)
            case _:
                self._when(block, file, scope, place)

    def _if(self, block: Block, file: File, scope: Scope, place: tuple[str, ...]) -> None:
        head = block.head
        assert head.expression is not None
        try:
            holds = bool(evaluate(head.expression, scope).value)
        except EvaluationError as error:
            file.findings.add(error.code, error.message, head.span(error.place), error.help)
            self._steps.append(Gap())
            return
        chosen = block.body if holds else (block.otherwise or ())
        self._nodes(chosen, file, Scope(scope), place)

    def _repeat(self, block: Block, file: File, scope: Scope, place: tuple[str, ...]) -> None:
        head = block.head
        refuse_parts(head, _NOT_FOR_BLOCKS, file.findings)
        values = _values(head)
        word = values[0] if values and isinstance(values[0], Word) else None
        count = self._count(head, values[1:] if word else values, file, scope)
        if word is not None and not may_be_declared(head, word, scope, self._robot, file.findings):
            word = None
        if count is None:
            self._steps.append(Gap())
            return
        where = None if word is None else Where(file.findings.source, head.span(word.place))
        for number in range(count):
            inner = Scope(scope)
            if word is not None:
                inner.declare(word.name, Amount(float(number)), where)
            label = f"{word.name}={number}" if word is not None else f"#{number}"
            before = self._commands
            self._nodes(block.body, file, inner, _looped(place, label))
            if self._commands == before:
                self._count_command()  # loops around nothing end as well

    def _count(self, head: Statement, values: list[Value], file: File, scope: Scope) -> int | None:
        """How often a REPEAT repeats."""
        example = "for example REPEAT I 4, or REPEAT $ROWS"
        if len(values) != 1 or not isinstance(values[0], Number | Computed):
            file.findings.add(
                "Y0401", "REPEAT wants a name and a number, or a number", head.whole_span, example
            )
            return None
        span = head.span(values[0].place)
        if (fault := number_fault(values[0])) is not None:
            file.findings.add(fault[0], fault[1], span, fault[2])
            return None
        found = amount(values[0], scope, head, file.findings)
        if found is None:
            return None
        whole = round(found.value)
        # 3 * 0.1 * 10 is meant as 3
        if found.unit is not None or whole < 0 or abs(found.value - whole) > 1e-9 * max(1, whole):
            file.findings.add("Y0414", f"REPEAT {found}: a whole number, 0 or more, is wanted", span, example)
            return None
        if whole > MOST_COMMANDS:
            message = f"REPEAT {whole:,}: a program has at most {MOST_COMMANDS:,} commands"
            file.findings.add("Y1004", message, span, "make the loop shorter")
            return None
        return whole

    def _when(self, block: Block, file: File, scope: Scope, place: tuple[str, ...]) -> None:
        when = read_when(block.head, scope, file.findings)
        if when is None:
            self._steps.append(Gap())
            return
        self._steps.append(when)
        self._count_command()
        self._whens += 1
        self._nodes(block.body, file, Scope(scope), place)
        if block.otherwise is not None:
            head = block.otherwise_head or block.head
            self._steps.append(Else(replace(origin_of(head, "ELSE", file.findings), place=when.origin.place)))
            self._nodes(block.otherwise, file, Scope(scope), place)
        self._whens -= 1
        end = block.end or block.head
        self._steps.append(EndWhen(replace(origin_of(end, "END", file.findings), place=when.origin.place)))

    # declarations

    def _declaration(self, statement: Statement, file: File, scope: Scope) -> None:
        word, findings = statement.name.name, file.findings
        span = statement.span(statement.name.place)
        if word in _ONCE and word in file.seen:
            findings.add(
                "Y0206", f"{word} stands in line {file.seen[word]} already", span, "leave one of them"
            )
            return
        if word in _AT_THE_TOP and file.command_seen:
            findings.add("Y0208", f"{word} stands behind a command", span, "move it above the first command")
            return
        file.seen.setdefault(word, statement.line)
        if not file.is_program and word in ("ROBOT", "START"):
            findings.add("Y0208", f"{word} belongs into the program, not into a module", span, "take it away")
            return
        match word:
            case "ROBOT":
                check_robot(statement, findings)
            case "DEFAULT":
                file.defaults = read_default(statement, scope, findings)
            case "START":
                self._start = read_start(statement, self._robot, scope, file.defaults, findings)
            case "FRAME" | "FRAME_QUAT":
                declare_frame(statement, scope, file.defaults, self._robot, findings)
            case "JOINTS":
                declare_joints(statement, scope, file.defaults, self._robot, findings)
            case "LET":
                declare_number(statement, scope, self._robot, findings)
            case "INPUT" | "OUTPUT":
                output = declare_signal(statement, scope, self._robot, self._signals, findings)
                if output is not None:
                    self._outputs.append(output)
            case "USE":
                self._use(statement, file, scope)
            case "CELL":
                self._outputs += self._cells.read(statement, scope, self._signals, findings, file.is_program)

    def _use(self, statement: Statement, file: File, scope: Scope) -> None:
        values = _values(statement)
        if len(values) != 1 or not isinstance(word := values[0], Word):
            file.findings.add(
                "Y0401", "USE wants the name of a module", statement.whole_span, "for example USE PALLET"
            )
            return
        span = statement.span(word.place)
        if word.name in self._loading:
            chain = " > ".join((*self._loading[self._loading.index(word.name) :], word.name))
            file.findings.add(
                "Y0213", f"the modules use each other in a circle: {chain}", span, "take one USE away"
            )
            self._steps.append(Gap())
            return
        if not may_be_declared(statement, word, scope, self._robot, file.findings):
            return
        library = self._modules.get(word.name) or self._load(word, span, file)
        if library is not None:
            scope.declare(word.name, library, Where(file.findings.source, span))
        else:
            self._steps.append(Gap())

    def _load(self, word: Word, span: Span, file: File) -> Library | None:
        load = self._context.load
        loaded = load(word.name) if load is not None else None
        if loaded is None:
            file.findings.add("Y0213", f"no module is named {word.name}", span, "modules can't be read here")
            return None
        module = loaded.value
        if module is None:
            file.findings.found += [
                replace(one, source=file.findings.source, span=span) for one in loaded.diagnostics
            ]
            return None
        inner = self._file(module, is_program=False)
        inner.findings.found += loaded.diagnostics
        check_indices(commands_of(module), inner.findings)
        self._loading.append(word.name)
        try:
            nodes = self._arranged(module, inner)
            self._resolve_all(nodes, inner)
            for node in nodes:
                self._module_node(node, inner)
        finally:
            self._loading.pop()
        library = Library(inner.scope)
        self._modules[word.name] = library
        return library

    def _module_node(self, node: Node, file: File) -> None:
        """What a module may have outside its SUBs: declarations."""
        if isinstance(node, Block) and node.head.name.name == "SUB":
            self._sub(node, file, file.scope)
        elif isinstance(node, Statement) and node.index is None and node.name.name in DECLARATIONS:
            self._declaration(node, file, file.scope)
        else:
            head = node.head if isinstance(node, Block) else node
            message = "a module has commands only in its SUBs"
            file.findings.add("Y0208", message, head.head_span, "put it into a SUB")
            self._steps.append(Gap())

    # SUBs

    def _sub(self, block: Block, file: File, scope: Scope) -> None:
        values = _values(block.head)
        if not values or not isinstance(word := values[0], Word | Parameter):
            message = "SUB wants a name, and what it is given"
            file.findings.add(
                "Y0401", message, block.head.whole_span, "for example SUB DRILL {AT} DEPTH (mm)"
            )
            return
        refuse_parts(block.head, _NOT_FOR_BLOCKS, file.findings)
        word = word.word if isinstance(word, Parameter) else word
        if may_be_declared(block.head, word, scope, self._robot, file.findings):
            # what is declared behind it isn't known in it; its own name is, so that recursion is seen
            sub = Sub(block, scope, file)
            scope.declare(word.name, Routine(sub), Where(file.findings.source, block.head.span(word.place)))
            sub.scope = _snapshot(scope)
            check_parameters(block.head, sub.scope, self._robot, file.findings)

    def _call(self, statement: Statement, file: File, scope: Scope, place: tuple[str, ...]) -> None:
        findings = file.findings
        findings.place = _shown(_at(place, _index(statement))) if place else ""
        refuse_parts(statement, _NOT_FOR_BLOCKS, findings)
        values = _values(statement)
        if not values or not isinstance(word := values[0], Word):
            findings.add(
                "Y0401",
                "CALL wants the name of a SUB",
                statement.whole_span,
                "for example CALL DRILL {HOLE} 20",
            )
            self._steps.append(Gap())
            return
        found = scope.name(word.name)
        span = statement.span(word.place)
        if not isinstance(found, Routine) or not isinstance(sub := found.sub, Sub):
            if found is not None:
                findings.add("Y0209", f"{word.text} is {KINDS[type(found)]}, not a SUB", span)
            elif any(one.name == word.name and one.file is file for one in self._calls):
                self._refuse_recursion(word, span, findings)
            else:
                known = sorted(set(scope.names(Routine)))
                help_ = suggest(word.text, known) or (f"there are {', '.join(known)}" if known else "")
                findings.add("Y0210", f"no SUB is named {word.text}", span, help_)
            self._steps.append(Gap())
            return
        if sub in self._calls:
            self._refuse_recursion(word, span, findings)
            self._steps.append(Gap())
            return
        inner, head, source = Scope(sub.scope), sub.block.head, sub.file.findings.source
        if not bind(statement, scope, findings, head, source, inner):
            self._steps.append(Gap())
            return
        self._calls.append(sub)
        self._given.append(given_by(statement, findings.source, head, source))
        try:
            self._nodes(sub.block.body, sub.file, inner, (*_at(place, _index(statement)), ""))
        finally:
            self._calls.pop()
            self._given.pop()
            sub.file.findings.place = ""

    def _refuse_recursion(self, word: Word, span: Span, findings: Collector) -> None:
        names = [one.name for one in self._calls]
        through = names[names.index(word.name.rpartition(".")[2]) + 1 :]
        how = f"{word.text} calls itself" + (f" through {', '.join(through)}" if through else "")
        findings.add("Y0212", how, span, "a program must end: use REPEAT")

    # commands

    def _command(self, statement: Statement, file: File, scope: Scope, place: tuple[str, ...]) -> None:
        file.command_seen = True
        self._count_command()
        if self._ended is not None:
            if not self._told_unreachable:
                message = f"this is never reached: {self._ended} ends the program"
                file.findings.add(
                    "Y1001", message, statement.head_span, "move STOP to the end, or take it away"
                )
            self._told_unreachable = True
            return
        word = statement.name.name
        if word == "CALL":
            self._call(statement, file, scope, place)
            return
        where = _at(place, _index(statement))
        file.findings.place = _shown(where) if place else ""
        given, before = self._given[-1] if self._given else {}, len(file.findings.found)
        step: Step | None
        if word in ACTIONS:
            step = read_action(statement, scope, file.defaults, file.findings)
        else:
            name = self._resolved(statement, file)
            step = None if name is None else self._read(statement, name, file, scope, is_alone=not place)
        if isinstance(step, Stop) and self._whens:
            message = "STOP in a WHEN is not carried out by this version"
            file.findings.add("Y0207", message, statement.head_span, "write HOLD, or move it behind the END")
            step = None
        name_arguments(statement, file.findings, before, given)
        if (
            given
            and step is not None
            and not isinstance(step, Gap)
            and (told := said_of_time(statement.time, given))
        ):
            step = replace(step, origin=replace(step.origin, time_given=told))
        self._steps.append(step or Gap())
        if isinstance(step, Stop):
            self._ended = step.origin.label or "STOP"

    def _read(
        self, statement: Statement, name: ResolvedName, file: File, scope: Scope, *, is_alone: bool
    ) -> Step | None:
        """The step of a command; `is_alone`: it stands in no loop and no SUB, and is worth remembering."""
        context, findings = self._context, file.findings

        def make(defaults: Defaults, names: Scope) -> Step | None:
            return to_step(statement, name, context, defaults, names, findings)

        if not is_alone or isinstance(context.memory, Forgetful):
            return make(file.defaults, scope)
        return step_before(context.memory, context.robot, statement, file.defaults, scope, findings, make)

    def _resolved(self, statement: Statement, file: File) -> ResolvedName | None:
        """A command's name is taken apart once, however often it is unrolled."""
        key = (id(file), statement.line)
        if key not in self._names:
            self._names[key] = resolve_name(statement, self._context.profiles, file.findings)
        return self._names[key]

    def _resolve_all(self, nodes: tuple[Node, ...], file: File) -> None:
        """Names of commands are looked up even where nothing leads to them."""
        for node in nodes:
            if isinstance(node, Block):
                self._resolve_all((*node.body, *(node.otherwise or ())), file)
            elif node.index is None and node.name.name in DECLARATIONS:
                continue
            elif node.name.name not in (*ACTIONS, "CALL"):
                self._resolved(node, file)

    def _count_command(self) -> None:
        self._commands += 1
        if self._commands > MOST_COMMANDS:
            raise TooManyCommands


def _snapshot(scope: Scope) -> Scope:
    """The names that are known now; what comes later stays outside."""
    return scope.copy()


def _shown(place: tuple[str, ...]) -> str:
    """A place as messages show it."""
    return ">".join(part for part in place if part)


def _index(statement: Statement) -> str:
    return f"P{int(statement.index.text[1:]):04d}" if statement.index else f"line {statement.line}"


def _looped(place: tuple[str, ...], label: str) -> tuple[str, ...]:
    """The place inside a loop: its count goes to the command that comes next."""
    *outer, last = place or ("",)
    inside = f"{last[:-1]},{label})" if last.endswith(")") and last.startswith("(") else f"({label})"
    return (*outer, inside)


def _at(place: tuple[str, ...], index: str) -> tuple[str, ...]:
    """The place of a command: the loops that it is in stand behind its index."""
    if place and (place[-1] == "" or place[-1].startswith("(")):
        return (*place[:-1], index + place[-1])
    return (*place, index)


def _values(statement: Statement) -> list[Value]:
    return [value for waypoint in statement.waypoints for value in waypoint.values]
