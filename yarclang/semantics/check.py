"""The checks, in order: declarations, indices, names, arguments, flow."""

from __future__ import annotations

from yarclang.diagnostics import Collector, Edit, Fix, Result
from yarclang.hir import Program
from yarclang.semantics.context import Context
from yarclang.semantics.unroll import unroll
from yarclang.source import Span
from yarclang.syntax.ast import Module, Statement
from yarclang.syntax.words import DECLARATIONS


def check(module: Module, context: Context) -> Result[Program]:
    """Check a module, and carry out its loops and calls.

    Returns:
        The program. A command with errors is a Gap in it, so that the planner can
        still find what is wrong with the others. The value is never None.
    """
    findings = Collector(module.source)
    commands = [statement for statement in module.statements if not _is_declaration(statement)]
    if context.index_needed:
        _check_indices(commands, findings)
    unrolled = unroll(module, context)
    if not commands and not module.unreadable_lines:
        findings.add("Y0104", "the file has no command", Span.on_line(1, 1, 2), "was another file meant?")
    known = (context.start, unrolled.start, context.fallback_start, context.robot.home)
    start = next(one for one in known if one is not None)
    program = Program(module.source, start, tuple(unrolled.steps), tuple(unrolled.outputs))
    return Result(program, (*findings.found, *unrolled.findings))


def _is_declaration(statement: Statement) -> bool:
    return statement.index is None and statement.name.name in DECLARATIONS


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
