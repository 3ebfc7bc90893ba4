"""Read UNTIL (a search: a motion that ends when an input changes), and check the commands that follow it."""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.cell.model import Cell
from yarclang.decisions import DECIMALS, Constant, Register, is_group
from yarclang.diagnostics import Collector, Diagnostic
from yarclang.hir import (
    Assign,
    Dwell,
    EndWhen,
    Finish,
    Gap,
    Hold,
    JointDelta,
    JointMove,
    LineMove,
    Motion,
    PoseDelta,
    Reading,
    Say,
    Search,
    SetOutput,
    Signal,
    Step,
    Stop,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.semantics.declared.signals import state_value
from yarclang.semantics.motions.line import Line
from yarclang.semantics.names.scope import KINDS
from yarclang.semantics.names.signals import input_named
from yarclang.subjects import unknown
from yarclang.syntax.ast import Option, Word

_STANDING = (SetOutput, Dwell, WaitInput, WaitUntil, Hold, Say, Assign)
"""Steps that don't move the robot and are allowed after a search."""


def search_of(line: Line, blend: Reading | None) -> Search | None:
    """Read the option UNTIL of a motion, such as UNTIL TOUCH or UNTIL TOUCH OFF, and INTO DEPTH if it
    follows.

    Args:
        line: the command.
        blend: the command's BLEND; None without one.

    Returns:
        None without UNTIL, or with a finding if the option is wrong.
    """
    options = {option.word.name: option for option in line.statement.options}
    until, into = options.get("UNTIL"), options.get("INTO")
    if until is None:
        if into is not None:
            _refuse(
                line,
                into,
                "INTO is allowed only with UNTIL: it names the register for the travelled distance",
                "remove it",
            )
        return None
    if not line.name.spec.may_search or line.name.avoids:
        _refuse(
            line,
            until,
            f"UNTIL is allowed only with MOVEL and MOVEJ, not with {line.name.full}",
            "write MOVEL",
        )
        return None
    if blend is not None:
        message = "a motion with UNTIL can't have BLEND: its end isn't known in advance"
        _refuse(line, options["BLEND"], message, "remove BLEND")
        return None
    if not isinstance(until.argument, Word):
        _refuse(line, until, "UNTIL needs an input", "for example UNTIL TOUCH, or UNTIL TOUCH OFF")
        return None
    signal = input_named(until.argument, line.scope, line.statement, line.findings)
    value = (
        1.0 if until.state is None else state_value(until.state, line.scope, line.statement, line.findings)
    )
    depth = "" if into is None else _depth(line, into)
    if signal is None or value is None or depth is None:
        return None
    if is_group(signal.variable):
        message = f"{signal.name} is a group of {len(signal.bits)} bits, and UNTIL takes a single bit"
        line.findings.add(
            "Y0471",
            message,
            line.statement.span(until.argument.place),
            "declare this bit under a name of its own",
        )
        return None
    return Search(signal.variable, round(value, DECIMALS) + 0.0, signal.name, depth=depth)


def _depth(line: Line, into: Option) -> str | None:
    """Return the register that INTO names; None with a finding if it names no register, or if the motion is
    not linear.
    """
    if not line.name.spec.moves_frame:
        _refuse(
            line, into, "INTO is allowed only with MOVEL: a joint motion has no length in mm", "remove it"
        )
        return None
    found = line.scope.name(into.argument.name) if isinstance(into.argument, Word) else None
    if isinstance(found, Register):
        return found.name
    span = line.statement.span((into.argument or into.word).place)
    if found is not None and isinstance(into.argument, Word):
        line.findings.add("Y0209", f"{into.argument.text} is {KINDS[type(found)]}, not a register", span)
        return None
    text = "" if into.argument is None else into.argument.text
    subject = unknown(text, line.scope.names(Register))
    help_ = subject.question or "declare it: REGISTER DEPTH 0..50000, in 0.01 mm"
    line.findings.add(
        "Y0210",
        f"no register is named {text}" if text else "INTO needs a register",
        span,
        help_,
        subject=subject,
    )
    return None


def _refuse(line: Line, option: Option, message: str, help_: str) -> None:
    line.findings.add("Y0412", message, line.statement.span(option.word.place), help_)


def bound_searches(steps: list[Step], cell: Cell | None, findings: Collector) -> None:
    """Check the steps after each search (a motion with UNTIL). After a search the robot must stay at rest
    until a motion to a place that is known in advance, without BLEND.

    Insert a barrier after this motion. When the search has ended, the steps up to this barrier are planned
    again.

    Args:
        steps: steps of the program; receive the barriers.
        cell: the cell around the robot. If it has parts, grippers must not act where a search has ended.
        findings: receives the findings.
    """
    grips = set() if cell is None or not cell.parts else {*cell.grips, *cell.removals}
    for number in range(len(steps) - 1, -1, -1):
        step = steps[number]
        if isinstance(step, JointMove | LineMove) and step.search is not None:
            told = _behind(steps, number, step, grips)
            if isinstance(told, Diagnostic):
                findings.found.append(told)
            elif told is not None:
                steps.insert(told + 1, Assign(step.origin, step.search.flag, Constant(0.0)))


def _behind(steps: Sequence[Step], number: int, search: Motion, grips: set[str]) -> int | Diagnostic | None:
    """Find the first motion after a search (a motion with UNTIL).

    Args:
        steps: steps of the program.
        number: number of the search's step.
        search: the search.
        grips: variables of outputs that make a gripper take or put down parts.

    Returns:
        The number of the motion; a finding if a step before it isn't allowed; None if no motion follows.
    """
    for at in range(_end_of_when(steps, number + 1) + 1, len(steps)):
        step = steps[at]
        if isinstance(step, Gap | Stop | Finish):
            return None
        origin = step.origin
        if isinstance(step, SetOutput | Assign):
            target = step.output if isinstance(step, SetOutput) else step.target
            if isinstance(target, Signal) and target.variable in grips:
                message = (
                    f"{target.name} takes or puts down a part at the end of {search.origin.name}, which is "
                    "known only when the program runs"
                )
                help_ = "in a cell with parts, move to a known place first"
                return Diagnostic("Y0950", message, origin.source, origin.span, help_, place=origin.place)
        if isinstance(step, _STANDING):
            continue
        if (
            isinstance(step, JointMove | LineMove)
            and step.search is None
            and step.blend is None
            and not isinstance(step.goal, JointDelta | PoseDelta)
        ):
            return at
        message = (
            f"{origin.name} begins at the end of {search.origin.name}, which is known only when the program "
            "runs"
        )
        help_ = "write a MOVEL or MOVEJ to an absolute place, without BLEND, before this line"
        return Diagnostic("Y0475", message, origin.source, origin.span, help_, place=origin.place)
    return None


def _end_of_when(steps: Sequence[Step], first: int) -> int:
    """Return the number of the EndWhen that belongs to the When at `first`. If there is none, return the
    number of the last step.
    """
    depth = 0
    for number in range(first, len(steps)):
        depth += isinstance(steps[number], When) - isinstance(steps[number], EndWhen)
        if depth == 0:
            return number
    return len(steps) - 1
