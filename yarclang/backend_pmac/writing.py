"""Conversion of a motion plan to the text of a program for a Turbo PMAC."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.backend import Written
from yarclang.backend_pmac.emit import emit, segment_time
from yarclang.backend_pmac.lower import lower
from yarclang.decisions import simple
from yarclang.diagnostics import Diagnostic, Result
from yarclang.hir import (
    Assign,
    Finish,
    Hold,
    Loop,
    Program,
    Say,
    SetOutput,
    Stop,
    WaitUntil,
    When,
    offsets_of,
    searches_of,
)
from yarclang.memory import Memory
from yarclang.motion.plan import MotionPlan
from yarclang.pmac.program import LOADING, MOST_IN_STEP, Target
from yarclang.robot.model import Tolerance
from yarclang.source import SourceFile, Span
from yarclang.units import MS


def streamed_only(program: Program) -> Diagnostic | None:
    """Return the finding for a program that only the runtime can execute; None if the program can be written
    for a program buffer.
    """
    for one in program.watches:
        message = f"{one.name} is watched by the runtime, without which a program buffer runs"
        return Diagnostic("Y1106", message, program.source, help="remove --target prog")
    for shifted in offsets_of(program):
        message = (
            f"goals in {{{shifted.frame}}} are planned by the runtime, without which a program buffer runs"
        )
        return Diagnostic("Y1106", message, program.source, help="remove --target prog")
    for found in searches_of(program):
        message = (
            f"a motion that {found.name} ends is replanned by the runtime, without which a program buffer "
            "runs"
        )
        return Diagnostic("Y1106", message, program.source, help="remove --target prog")
    for step in program.steps:
        if isinstance(step, Loop):
            message = (
                f"{step.origin.name} is repeated and left by the runtime, without which a program buffer runs"
            )
            help_ = "remove --target prog, or repeat a number of times: REPEAT 4"
            return Diagnostic("Y1106", message, step.origin.source, step.origin.span, help_)
        is_plain = (
            isinstance(step, When)
            and not step.again
            and step.within is None
            and simple(step.condition) is not None
        )
        if isinstance(step, Assign | When | WaitUntil) and not is_plain:
            message = f"{step.origin.name} is decided by the runtime, without which a program buffer runs"
            help_ = (
                "remove --target prog, or decide by one input: "
                f"{'WAIT' if isinstance(step, WaitUntil) or step.origin.name == 'WAIT' else 'WHEN'} DOOR ON"
            )
            return Diagnostic("Y1106", message, step.origin.source, step.origin.span, help_)
        if isinstance(step, Hold) and step.register:
            message = "the answer to a HOLD is read by the runtime, without which a program buffer runs"
            help_ = "remove --target prog, or hold without a register"
            return Diagnostic("Y1106", message, step.origin.source, step.origin.span, help_)
        if isinstance(step, Say):
            message = "SAY is executed by the runtime, without which a program buffer runs"
            help_ = "remove --target prog, or write HOLD"
            return Diagnostic("Y1106", message, step.origin.source, step.origin.span, help_)
        if isinstance(step, Finish):
            message = (
                f"{step.origin.name} ends the program in one of its branches, but in a program buffer an R "
                "would continue there"
            )
            help_ = "remove --target prog, or write HOLD"
            return Diagnostic("Y1106", message, step.origin.source, step.origin.span, help_)
    return None


def write(plan: MotionPlan, target: Target, tolerance: Tolerance, memory: Memory) -> Result[Written]:
    """Lower a motion plan to a controller program and print it.

    Args:
        plan: the plan.
        target: kind of the text, for a rotary buffer or for a program buffer.
        tolerance: tolerance of the path.
        memory: cache for the text of move lines.

    Returns:
        The text; None, with findings, if the program sets an output in motion that the controller can set at
        rest only.
    """
    if found := (*_set_at_rest_only(plan), *_too_many_at_once(plan)):
        return Result(None, found)
    lowered = lower(plan, target, tolerance)
    emitted = emit(lowered, memory)
    times = {motion.curve.segment for motion in plan.motions}
    ends = sorted({min(times), max(times)}) if times else ()
    written = Written(
        target=target,
        loading=LOADING[target].format(system=lowered.coordinate_system),
        start="".join(
            f"{axis}{value:.{lowered.decimals}f}"
            for axis, value in zip(lowered.axes, lowered.start, strict=True)
        ),
        segments=tuple(segment_time(time / MS) for time in ends),
        time=segment_time,
        text=emitted.text,
    )
    return Result(written)


def _set_at_rest_only(plan: MotionPlan) -> Iterator[Diagnostic]:
    """Yield a finding for each SET between flowing motions whose variable takes no synchronous assignment (an
    assignment in step with a move).

    Only M-variables take one (TUM, synchronous assignments).
    """
    flows, told = False, set[tuple[SourceFile, Span]]()
    flowing = {motion.step: motion.flows for motion in plan.motions}
    for number, step in enumerate(plan.program.steps):
        if isinstance(step, Stop):
            return
        if not isinstance(step, SetOutput):
            flows = flowing.get(number, False)
        elif flows and not step.output.variable.startswith("M"):
            origin, output = step.origin, step.output
            if (origin.source, origin.span) in told:  # reported before, for another pass of a loop
                continue
            told.add((origin.source, origin.span))
            message = (
                f"{output.name} is {output.variable}, but motions flow into each other here, and in motion "
                "the controller sets only M-variables"
            )
            help_ = f"give {output.name} an M-variable, or remove the BLEND of the motion before"
            yield Diagnostic("Y1105", message, origin.source, origin.span, help_, place=origin.place)


def _too_many_at_once(plan: MotionPlan) -> Iterator[Diagnostic]:
    """Yield a finding for each blend in which more outputs are set than the controller may store."""
    flowing = {motion.step: motion.flows for motion in plan.motions}
    flows, count = False, 0
    for number, step in enumerate(plan.program.steps):
        if isinstance(step, Stop):
            return
        if not isinstance(step, SetOutput):
            flows, count = flowing.get(number, False), 0
            continue
        count += flows
        if count == MOST_IN_STEP + 1:
            origin = step.origin
            message = f"more than {MOST_IN_STEP} bits of outputs are set in one blend"
            help_ = "set some of them after the next motion, or remove the BLEND of the motion before"
            yield Diagnostic("Y1107", message, origin.source, origin.span, help_, place=origin.place)
