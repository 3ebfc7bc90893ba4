"""Check a parsed module and turn it into a program."""

from __future__ import annotations

from dataclasses import replace

from yarclang.diagnostics import Collector, Result
from yarclang.hir import Program
from yarclang.identity import way_fingerprint
from yarclang.semantics.context import Context
from yarclang.semantics.control.unroll import unroll
from yarclang.semantics.indices import check_indices, commands_of
from yarclang.semantics.motions.allowing import check_allowed
from yarclang.semantics.motions.searching import bound_searches
from yarclang.source import Span
from yarclang.syntax.ast import Module


def check(module: Module, context: Context) -> Result[Program]:
    """Check a program's syntax tree, and convert it to steps: its loops and calls are carried out now.

    Args:
        module: the program's file.
        context: inputs besides the text.

    Returns:
        The program, which is never None. A command with errors becomes a Gap, so that the planner can still
        check the other commands.
    """
    findings = Collector(module.source)
    commands = commands_of(module)
    if context.index_needed:
        check_indices(commands, findings)
    unrolled = unroll(module, context)
    if not commands and not module.unreadable_lines:
        findings.add("Y0104", "the file has no command", Span.on_line(1, 1, 2), "was another file meant?")
    bound_searches(unrolled.steps, unrolled.cell, findings)
    if unrolled.cell is not None and unrolled.cell.parts:
        for way in unrolled.ways_out:
            message = (
                f"{way.name} can't be planned in a cell with parts: it isn't known which parts the robot "
                "carries then"
            )
            findings.add("Y0478", message, way.origin.span, "write HOLD instead of CALL")
    check_allowed(unrolled.steps, context.robot, unrolled.cell, findings)
    known = (context.start, unrolled.start, context.fallback_start, context.robot.home)
    start = next(one for one in known if one is not None)
    steps, outputs = tuple(unrolled.steps), tuple(unrolled.outputs)
    ways = {one.name: way_fingerprint(one) for one in unrolled.ways_out}
    program = Program(
        module.source,
        start,
        steps,
        outputs,
        unrolled.cell,
        unrolled.is_cut,
        registers=tuple(unrolled.registers),
        watches=tuple(
            replace(one, way=ways[one.then]) if one.then in ways else one for one in unrolled.watches
        ),
        ways_out=tuple(unrolled.ways_out),
    )
    return Result(program, (*findings.found, *unrolled.findings))
