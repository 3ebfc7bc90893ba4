"""Move findings in modules to the line of the program that calls the module. Users can change this line, but
often not the module.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from yarclang.diagnostics import Diagnostic, Result, Within, static_place
from yarclang.hir import Origin
from yarclang.pipeline.modules import loader
from yarclang.progress import each
from yarclang.semantics.control.places import index_of
from yarclang.semantics.files import values_of
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Block, Module, Node, Statement, Word
from yarclang.syntax.blocks import arrange
from yarclang.syntax.parse import parse

Load = Callable[[str], Result[Module]]


def at_callers(
    diagnostics: Iterable[Diagnostic], program: Module, load: Load | None
) -> tuple[Diagnostic, ...]:
    """Return all findings. Each finding in a module is moved to the CALL in the program's file through which
    the module's line is reached.

    The finding's place in the module is then in `within`. A finding in a line that no CALL reaches is moved
    to the USE of its module if the module is installed with yarclang; it stays in the module if the module
    is a file beside the program. A fix always stays with the module's line, since it can't be applied to the
    program's text.

    Args:
        diagnostics: findings.
        program: syntax tree of the program's file.
        load: function that reads a module by its name.
    """
    findings = tuple(diagnostics)
    if not any(_is_in_module(one, program) for one in findings):
        return findings
    calls = _Calls(program, load)
    return tuple(
        _at_caller(one, program, calls) if _is_in_module(one, program) else one for one in each(findings)
    )


def caller_of(origin: Origin, program: SourceFile) -> tuple[Span, Within] | None:
    """Return the CALL in the program through which a module's command is reached, and the command's place in
    the module.

    Returns:
        None for commands of the program itself.
    """
    source = origin.source
    tree = parse(program).value
    if not source.module or source.name == program.name or tree is None:
        return None
    statement, through = _Calls(tree, loader(Path(program.name).parent)).leading_to(origin.place)
    return None if statement is None else (_called_span(statement), Within(source, origin.span, through[1:]))


def uncalled_lines(program: Module) -> frozenset[int]:
    """Return the lines of all SUBs in a file that no line of this file calls. A module that is checked
    without a program has such SUBs.

    Findings in these lines matter only for some of the programs that use the module.
    """
    nodes = arrange(program).value or ()
    subs = {name: one for one in nodes if isinstance(one, Block) and (name := _sub_name(one))}
    if not subs:
        return frozenset()
    reached: set[str] = set()
    todo = [_called(one) for one in _commands(nodes)]
    while todo:
        name = todo.pop()
        if name in subs and name not in reached:
            reached.add(name)
            todo += [_called(one) for one in _commands(subs[name].body)]
    lines: set[int] = set()
    for name, block in subs.items():
        if name not in reached and block.end is not None:
            lines.update(range(block.head.line, block.end.line + 1))
    return frozenset(lines)


def _sub_name(block: Block) -> str:
    """Return the name of a SUB in upper case; empty for a block that is no SUB."""
    values = values_of(block.head) if block.head.name.name == "SUB" else []
    return values[0].text.upper() if values else ""


def _is_in_module(finding: Diagnostic, program: Module) -> bool:
    return (
        finding.source is not None
        and bool(finding.source.module)
        and finding.source.name != program.source.name
    )


def _at_caller(finding: Diagnostic, program: Module, calls: _Calls) -> Diagnostic:
    source, span = finding.source, finding.span
    assert source is not None
    statement, through = calls.leading_to(finding.place)
    if statement is None and source.is_installed:
        statement = calls.use_of(source.module)
    if statement is None or span is None:
        return finding
    within = Within(source, span, through[1:], None if source.is_installed else finding.fix)
    return replace(finding, source=program.source, span=_called_span(statement), fix=None, within=within)


def _called_span(statement: Statement) -> Span:
    """Return the span of a CALL or USE together with the name after it."""
    span, values = statement.head_span, values_of(statement)
    if not values or values[0].place.row:
        return span
    return span._replace(end_column=statement.span(values[0].place).end_column)


class _Calls:
    """Finder of the CALLs through which a program reaches a command in a module. The text of a file is split
    into blocks when it is first needed.
    """

    def __init__(self, program: Module, load: Load | None) -> None:
        self._program = program
        self._load = load
        self._nodes: dict[str, tuple[Node, ...]] = {}

    def leading_to(self, place: str) -> tuple[Statement | None, tuple[str, ...]]:
        """Follow the CALLs through which a command is reached.

        Args:
            place: place of the command in unrolled code, such as `P0020>P0010`.

        Returns:
            The last of these CALLs that is in the program's own file, and the names of the SUBs that are
            called from this CALL on. The CALL is None if the command isn't in a module.
        """
        module, nodes = "", self._of("")
        caller: Statement | None = None
        through: list[str] = []
        for index in static_place(place).split(">")[:-1]:
            statement = next((one for one in _commands(nodes) if index_of(one) == index), None)
            name = _called(statement)
            if statement is None or not name:
                break
            if not module:
                caller, through = statement, []
            through.append(name if "." in name or not module else f"{module}.{name}")
            library, dot, routine = name.rpartition(".")
            if dot:
                module = library
            nodes = _body(self._of(module), routine)
        return (caller if module else None), tuple(through)

    def use_of(self, module: str) -> Statement | None:
        """Return the USE line by which the program loads a module."""
        return next(
            (one for one in self._program.statements if one.name.name == "USE" and _called(one) == module),
            None,
        )

    def _of(self, module: str) -> tuple[Node, ...]:
        """Return the blocks of a module; empty if the module can't be read. The empty name means the program
        itself.
        """
        if module not in self._nodes:
            tree = self._program
            if module:
                loaded = self._load(module) if self._load is not None else None
                if loaded is None or loaded.value is None:
                    return ()
                tree = loaded.value
            self._nodes[module] = arrange(tree).value or ()
        return self._nodes[module]


def _called(statement: Statement | None) -> str:
    """Return the name after CALL or USE, in upper case; empty for other lines."""
    if statement is None or statement.name.name not in ("CALL", "USE"):
        return ""
    values = values_of(statement)
    return values[0].name if values and isinstance(values[0], Word) else ""


def _commands(nodes: Iterable[Node]) -> Iterator[Statement]:
    """Yield the statements among nodes, including the statements in loops and conditions, but not in SUBs."""
    for node in nodes:
        if isinstance(node, Statement):
            yield node
        elif node.head.name.name != "SUB":
            yield from _commands(node.body)
            yield from _commands(node.otherwise or ())


def _body(nodes: Iterable[Node], routine: str) -> tuple[Node, ...]:
    """Return the lines of a module's SUB, grouped into blocks."""
    for node in nodes:
        if isinstance(node, Block) and routine and _sub_name(node) == routine:
            return node.body
    return ()
