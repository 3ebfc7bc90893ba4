"""Carry out the declarations of the program and of its modules. A module is read at its USE line."""

from __future__ import annotations

from dataclasses import replace

from yarclang.decisions import Register, Watch
from yarclang.diagnostics import Collector
from yarclang.hir import Array, Gap, Output, Step
from yarclang.robot.model import Robot
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.control.parameters import check_parameters
from yarclang.semantics.declared.cells import Cells
from yarclang.semantics.declared.functions import declare_function
from yarclang.semantics.declared.meanings import (
    declare_frame,
    declare_joints,
    declare_number,
    declare_pose,
    may_be_declared,
)
from yarclang.semantics.declared.registers import declare_register, is_name_of_block
from yarclang.semantics.declared.signals import declare_signal
from yarclang.semantics.declared.tables import declare_table
from yarclang.semantics.declared.variables import Signals
from yarclang.semantics.declared.watching import declare_watch
from yarclang.semantics.declared.whole_file import check_robot, read_default, read_start
from yarclang.semantics.files import File, Sub, values_of
from yarclang.semantics.indices import check_indices, commands_of
from yarclang.semantics.names.commands import CommandNames
from yarclang.semantics.names.scope import Library, Routine, Scope, Where
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.source import Span
from yarclang.syntax.ast import Block, Module, Node, Parameter, Statement, Word
from yarclang.syntax.blocks import arrange
from yarclang.syntax.words import DECLARATIONS
from yarclang.words.registry import word_specs


class Declaring:
    """Reader of files and their declarations.

    Args:
        context: robot, modules and cells.
        names: resolver of the names of commands.
        steps: steps of the program. A Gap is added if a declaration that commands may need has an error.
    """

    def __init__(self, context: Context, names: CommandNames, steps: list[Step]) -> None:
        self.outputs: list[Output] = []
        self.registers: list[Register] = []
        self.watches: list[Watch] = []
        self.start: Array | None = None
        self.cells = Cells(context)
        self.collectors: list[Collector] = []
        """The findings of each file."""
        self._context = context
        self._robot: Robot = context.robot
        self._names = names
        self._steps = steps
        self._signals = Signals()
        self._loading: list[str] = []
        self._modules: dict[str, Library] = {}

    def file(self, module: Module, *, is_program: bool) -> File:
        """Return a new File for a parsed file; its declarations aren't read yet.

        Args:
            module: the parsed file.
            is_program: True for the program, False for a module.
        """
        findings = Collector(module.source)
        self.collectors.append(findings)
        scope = Scope(Scope.of_robot(self._robot))
        return File(findings, scope, Defaults(scope), is_program)

    def begin(self, file: File) -> None:
        """Declare the names of the cell that the command line or yarc.toml gives to the program."""
        self.outputs += self.cells.begin(file.scope, self._signals, file.findings)

    def arranged(self, module: Module, file: File) -> tuple[Node, ...]:
        """Return a file's statements, grouped into blocks. Names of commands are checked here, so that they
        are also checked in lines that are never carried out.
        """
        arranged = arrange(module)
        file.findings.found += arranged.diagnostics
        assert arranged.value is not None
        if any(one.is_error for one in arranged.diagnostics):
            self._steps.append(Gap())
        self._names.look_up(arranged.value, file.findings)
        return arranged.value

    def declare(self, statement: Statement, file: File, scope: Scope) -> None:
        """Carry out a declaration."""
        word, findings = statement.name.name, file.findings
        spec, span = word_specs()[word], statement.span(statement.name.place)
        if spec.once and word in file.seen:
            findings.add(
                "Y0206",
                f"{word} is given twice: already in line {file.seen[word]}",
                span,
                "remove one of them",
            )
            return
        if spec.at_the_top and file.command_seen:
            findings.add(
                "Y0208", f"{word} must come before the first command", span, "move it above the first command"
            )
            return
        file.seen.setdefault(word, statement.line)
        if not file.is_program and spec.of_programs:
            findings.add(
                "Y0208", f"{word} is allowed only in the program, not in a module", span, "remove it"
            )
            return
        match word:
            case "ROBOT":
                check_robot(statement, findings)
            case "DEFAULT":
                file.defaults = read_default(statement, scope, findings)
            case "START":
                self.start = read_start(statement, self._robot, scope, file.defaults, findings)
            case "FRAME" | "FRAME_QUAT":
                declare_frame(statement, scope, file.defaults, self._robot, findings)
            case "JOINTS":
                declare_joints(statement, scope, file.defaults, self._robot, findings)
            case "POSE":
                declare_pose(statement, scope, file.defaults, self._robot, findings)
            case "LET":
                declare_number(statement, scope, self._robot, findings)
            case "FUNC":
                declare_function(statement, scope, self._robot, findings)
            case "TABLE":
                declare_table(statement, scope, file.defaults, self._robot, findings)
            case "INPUT" | "OUTPUT":
                self.outputs += declare_signal(statement, scope, self._robot, self._signals, findings)
            case "REGISTER" | "ON" if not self._context.index_needed:
                message = f"{word} works only in a file: each typed line is carried out by itself"
                findings.add("Y0208", message, span, "write the lines into a file, and run the file")
            case "REGISTER":
                register = declare_register(statement, scope, self._robot, findings)
                is_taken = register is not None and any(one.name == register.name for one in self.registers)
                if register is not None and is_taken and is_name_of_block(register.name):
                    # an UNTIL, REPEAT, OFFSET or RETURN in a line above has chosen this name
                    message = f"a block above already uses the name {register.name} for a register of its own"
                    help_ = "choose another name, or move this line to the top of the program"
                    findings.add("Y0206", message, statement.whole_span, help_)
                elif register is not None:
                    self.registers.append(register)
            case "ON":
                watch = declare_watch(statement, scope, self.watches, findings)
                if watch is not None:
                    self.watches.append(watch)
            case "OF":
                help_ = "add the missing CASE before it, or the missing END above it"
                findings.add("Y0432", "this OF is not in a CASE", span, help_)
                self._steps.append(Gap())
            case "USE":
                self._use(statement, file, scope)
            case "CELL":
                self.outputs += self.cells.read(statement, scope, self._signals, findings, file.is_program)

    def declare_sub(self, block: Block, file: File, scope: Scope) -> None:
        """Declare a SUB; its body is carried out at each CALL."""
        values = values_of(block.head)
        if not values or not isinstance(word := values[0], Word | Parameter):
            message = "SUB needs a name, and parameters if it has any"
            file.findings.add(
                "Y0401", message, block.head.whole_span, "for example SUB DRILL {AT} DEPTH (mm)"
            )
            return
        refuse_parts(block.head, NOT_FOR_BLOCKS, file.findings)
        word = word.word if isinstance(word, Parameter) else word
        if may_be_declared(block.head, word, scope, self._robot, file.findings):
            # The SUB doesn't see names that are declared after it. It does see its own name, so that
            # recursion is found.
            sub = Sub(block, scope, file)
            scope.declare(word.name, Routine(sub), Where(file.findings.source, block.head.span(word.place)))
            sub.scope = scope.copy()
            check_parameters(block.head, sub.scope, self._robot, file.findings)

    def declare_only(self, node: Node, file: File) -> None:
        """Carry out a line of a module outside of its SUBs. Only declarations are allowed there: a command
        gets a finding.
        """
        if isinstance(node, Block) and node.head.name.name == "SUB":
            self.declare_sub(node, file, file.scope)
        elif isinstance(node, Statement) and node.index is None and node.name.name in DECLARATIONS:
            self.declare(node, file, file.scope)
        else:
            head = node.head if isinstance(node, Block) else node
            message = "this line is outside of a SUB: a module may have commands only in SUBs"
            file.findings.add("Y0208", message, head.head_span, "move this line into a SUB")
            self._steps.append(Gap())

    def _use(self, statement: Statement, file: File, scope: Scope) -> None:
        values = values_of(statement)
        if len(values) != 1 or not isinstance(word := values[0], Word):
            file.findings.add(
                "Y0401", "USE needs the name of a module", statement.whole_span, "for example USE PALLET"
            )
            return
        span = statement.span(word.place)
        if word.name in self._loading:
            chain = " > ".join((*self._loading[self._loading.index(word.name) :], word.name))
            file.findings.add(
                "Y0213", f"the modules use each other in a circle: {chain}", span, "remove one USE"
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
            file.findings.add(
                "Y0213",
                f"no module is named {word.name}",
                span,
                "a module can't be read here: this text is not a file",
            )
            return None
        module = loaded.value
        if module is None:
            file.findings.found += [
                replace(one, source=file.findings.source, span=span) for one in loaded.diagnostics
            ]
            return None
        inner = self.file(module, is_program=False)
        inner.findings.found += loaded.diagnostics
        check_indices(commands_of(module), inner.findings)
        self._loading.append(word.name)
        try:
            nodes = self.arranged(module, inner)
            for node in nodes:
                self.declare_only(node, inner)
        finally:
            self._loading.pop()
        library = Library(inner.scope)
        self._modules[word.name] = library
        return library
