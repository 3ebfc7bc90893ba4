"""Loops, conditions and calls carried out: a file's blocks to a flat list of steps.

Every command knows its place: what led to it, from outside in, as `P0020(I=2)>P0010`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic
from yarclang.hir import Array, Else, EndWhen, Gap, Output, Step, Stop
from yarclang.memory import Forgetful
from yarclang.semantics.actions import read_action, read_when
from yarclang.semantics.amounts import Amount
from yarclang.semantics.arguments import name_arguments, said_of_time
from yarclang.semantics.calling import Calls
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.declaring import Declaring
from yarclang.semantics.evaluate import EvaluationError, evaluate
from yarclang.semantics.files import File, values_of
from yarclang.semantics.names import ACTIONS, CommandNames, ResolvedName
from yarclang.semantics.naming import may_be_declared
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.semantics.places import Place, at, looped, shown
from yarclang.semantics.recalling import step_before
from yarclang.semantics.repeats import MOST_COMMANDS, repeats
from yarclang.semantics.scope import Scope, Where
from yarclang.semantics.to_hir import origin_of, to_step
from yarclang.source import Span
from yarclang.syntax.ast import Block, Module, Node, Statement, Word
from yarclang.syntax.words import DECLARATIONS


class TooManyCommands(Exception):  # noqa: N818 - ends the unrolling, and is told as a finding
    """The program is longer than is ever planned."""


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
    return _Unroller(context).program(module)


def declared_names(module: Module, context: Context) -> Scope:
    """What the names mean that a file declares outside of blocks, and the SUBs; what is wrong with them is left unsaid.

    Nothing else is carried out: this is for whoever shows what a name means, in a program that may have errors.
    """
    declaring = Declaring(context, CommandNames(context.profiles), [])
    file = declaring.file(module, is_program=True)
    for node in declaring.arranged(module, file):
        word = node.head.name.name if isinstance(node, Block) else node.name.name
        if word == "SUB" or (isinstance(node, Statement) and node.index is None and word in DECLARATIONS):
            declaring.declare_only(node, file)
    return file.scope


class _Unroller:
    def __init__(self, context: Context) -> None:
        self._context = context
        self._steps: list[Step] = []
        self._names = CommandNames(context.profiles)
        self._declaring = Declaring(context, self._names, self._steps)
        self._calls = Calls()
        self._commands = 0
        self._whens = 0
        self._ended: str | None = None
        self._told_unreachable = False

    def program(self, module: Module) -> Unrolled:
        """The whole program."""
        declaring, cells = self._declaring, self._declaring.cells
        file = declaring.file(module, is_program=True)
        try:
            nodes = declaring.arranged(module, file)
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
        if cells.broken:
            self._steps[:] = [Gap()]  # poses and positions that aren't what they should be needn't be planned
        found = [one for collector in declaring.collectors for one in collector.found]
        told = cells.without_followers(found)
        return Unrolled(self._steps, declaring.start, declaring.outputs, cells.cell, told)

    def _nodes(self, nodes: tuple[Node, ...], file: File, scope: Scope, place: Place) -> None:
        where = shown(place)
        for node in nodes:
            file.findings.place = where
            if isinstance(node, Block):
                self._block(node, file, scope, place)
            elif node.index is None and node.name.name in DECLARATIONS:
                self._declaring.declare(node, file, scope)
            else:
                self._command(node, file, scope, place)

    def _block(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        match block.head.name.name:
            case "SUB":
                self._declaring.declare_sub(block, file, scope)
            case "REPEAT":
                self._repeat(block, file, scope, place)
            case "IF":
                self._if(block, file, scope, place)
            case _:
                self._when(block, file, scope, place)

    def _if(self, block: Block, file: File, scope: Scope, place: Place) -> None:
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

    def _repeat(self, block: Block, file: File, scope: Scope, place: Place) -> None:
        head = block.head
        refuse_parts(head, NOT_FOR_BLOCKS, file.findings)
        values = values_of(head)
        word = values[0] if values and isinstance(values[0], Word) else None
        count = repeats(head, values[1:] if word else values, scope, file.findings)
        if word is not None and not may_be_declared(head, word, scope, self._context.robot, file.findings):
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
            self._nodes(block.body, file, inner, looped(place, label))
            if self._commands == before:
                self._count_command()  # loops around nothing end as well

    def _when(self, block: Block, file: File, scope: Scope, place: Place) -> None:
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

    def _call(self, statement: Statement, file: File, scope: Scope, place: Place) -> None:
        findings = file.findings
        findings.place = shown(at(place, statement)) if place else ""
        refuse_parts(statement, NOT_FOR_BLOCKS, findings)
        begun = self._calls.begin(statement, file, scope)
        if begun is None:
            self._steps.append(Gap())
            return
        sub, inner = begun
        try:
            self._nodes(sub.block.body, sub.file, inner, (*at(place, statement), ""))
        finally:
            self._calls.end()

    def _command(self, statement: Statement, file: File, scope: Scope, place: Place) -> None:
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
        file.findings.place = shown(at(place, statement)) if place else ""
        given, before = self._calls.given, len(file.findings.found)
        step: Step | None
        if word in ACTIONS:
            step = read_action(statement, scope, file.defaults, file.findings)
        else:
            name = self._names.resolved(statement, file.findings)
            step = None if name is None else self._read(statement, name, file, scope, is_alone=not place)
        if isinstance(step, Stop) and self._whens:
            message = "STOP in a WHEN is not carried out by this version"
            file.findings.add("Y0207", message, statement.head_span, "write HOLD, or move it behind the END")
            step = None
        if given:
            name_arguments(statement, file.findings, before, given)
            told = said_of_time(statement.time, given)
            if told and step is not None and not isinstance(step, Gap):
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

    def _count_command(self) -> None:
        self._commands += 1
        if self._commands > MOST_COMMANDS:
            raise TooManyCommands
