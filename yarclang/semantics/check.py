"""The checks, in order: declarations, indices, names, arguments, flow."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.diagnostics import Collector, Edit, Fix, Result
from yarclang.hir import Array, Gap, Program, Step, Stop
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.declarations import check_robot, read_default, read_start
from yarclang.semantics.names import resolve_name
from yarclang.semantics.to_hir import check_limits, to_step
from yarclang.source import Span
from yarclang.syntax.ast import Module, Statement
from yarclang.syntax.words import DECLARATIONS

_CARRIED_OUT = {"ROBOT", "DEFAULT", "START"}


def check(module: Module, context: Context) -> Result[Program]:
    """Check a module.

    Returns:
        The program. A command with errors is a Gap in it, so that the planner can
        still find what is wrong with the others. The value is never None.
    """
    findings = Collector(module.source)
    commands = [statement for statement in module.statements if not _is_declaration(statement)]
    defaults, start = _declarations(module, context, findings)
    if context.index_needed:
        _check_indices(commands, findings)
    steps = tuple(_steps(module, context, defaults, findings))
    if not commands and not module.unreadable_lines:
        findings.add("Y0104", "the file has no command", Span.on_line(1, 1, 2), "was another file meant?")
    known = (context.start, start, context.fallback_start, context.robot.home)
    program = Program(module.source, next(one for one in known if one is not None), steps)
    return Result(program, tuple(findings.found))


def _is_declaration(statement: Statement) -> bool:
    return statement.index is None and statement.name.name in DECLARATIONS


def _declarations(module: Module, context: Context, findings: Collector) -> tuple[Defaults, Array | None]:
    """What DEFAULT and START say; all declarations stand before the first command, each once."""
    defaults, start = Defaults(), None
    seen: dict[str, int] = {}
    command_seen = False
    for statement in module.statements:
        if not _is_declaration(statement):
            command_seen = True
            continue
        word, span = statement.name.name, statement.span(statement.name.place)
        if word not in _CARRIED_OUT:
            findings.add("Y0207", f"{word} is not carried out by this version", span, "take the line away")
        elif word in seen:
            findings.add("Y0206", f"{word} stands in line {seen[word]} already", span, "leave one of them")
        elif command_seen:
            findings.add("Y0208", f"{word} stands behind a command", span, "move it above the first command")
        elif word == "ROBOT":
            check_robot(statement, findings)
        elif word == "DEFAULT":
            defaults = read_default(statement, context.robot, findings)
        else:
            start = read_start(statement, context.robot, defaults, findings)
            if start is not None:
                check_limits(context.robot, start, findings, statement.whole_span)
        seen.setdefault(word, statement.line)
    return defaults, start


def _check_indices(commands: list[Statement], findings: Collector) -> None:
    """Every command has an index; each is there once; they ascend."""
    lines: dict[int, int] = {}
    out_of_order: Statement | None = None
    last = -1
    for statement in commands:
        if statement.index is None:
            span = statement.span(statement.name.place)
            help_ = "write P0010 (any number that isn't taken) before the name"
            findings.add("Y0105", f"{statement.name.text} has no index", span, help_)
            continue
        number, span = int(statement.index.text[1:]), statement.span(statement.index.place)
        if number in lines:
            message = f"the index P{number:04d} stands in line {lines[number]} already"
            findings.add("Y0201", message, span, f"P{max(lines) + 1:04d} is free")
            continue
        if number < last and out_of_order is None:
            out_of_order = statement
        lines[number] = statement.line
        last = max(last, number)
    if out_of_order is not None and out_of_order.index is not None:
        span = out_of_order.span(out_of_order.index.place)
        edits = tuple(
            Edit(statement.span(statement.index.place), f"P{number:04d}")
            for number, statement in enumerate((one for one in commands if one.index), 1)
            if statement.index
        )
        message = f"the index {out_of_order.index.text} is smaller than one above it"
        findings.add("Y1201", message, span, "renumber the commands", Fix("renumber the commands", edits))


def _steps(module: Module, context: Context, defaults: Defaults, findings: Collector) -> Iterator[Step]:
    """The commands in order, with a Gap for each that has errors or couldn't be read."""
    unreadable = list(module.unreadable_lines)
    ended_by: Stop | None = None
    told = False
    for statement in module.statements:
        while unreadable and unreadable[0] < statement.line:
            unreadable.pop(0)
            yield Gap()
        if _is_declaration(statement):
            continue
        name = resolve_name(statement, context.profiles, findings)
        step = to_step(statement, name, context, defaults, findings) if name else None
        if ended_by is not None:
            if not told:
                message = f"this is never reached: {ended_by.origin.index or 'STOP'} ends the program"
                findings.add("Y1001", message, statement.head_span, "move STOP to the end, or take it away")
            told = True
            continue
        yield step or Gap()
        if isinstance(step, Stop):
            ended_by = step
    yield from (Gap() for _ in unreadable)
