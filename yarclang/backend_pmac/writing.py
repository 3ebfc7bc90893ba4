"""A motion plan to the text of a program for a Turbo PMAC."""

from __future__ import annotations

from yarclang.backend import Written
from yarclang.backend_pmac.emit import emit, segment_time
from yarclang.backend_pmac.lower import lower
from yarclang.decisions import simple
from yarclang.diagnostics import Diagnostic
from yarclang.hir import Program, SetRegister, When
from yarclang.memory import Memory
from yarclang.motion.plan import MotionPlan
from yarclang.pmac.program import LOADING, Target
from yarclang.robot.model import Tolerance
from yarclang.units import MS


def streamed_only(program: Program) -> Diagnostic | None:
    """Return what is said of a program that can't be carried out by a program buffer alone; None if it can."""
    for step in program.steps:
        is_plain = isinstance(step, When) and not step.again and simple(step.condition) is not None
        if isinstance(step, SetRegister | When) and not is_plain:
            message = f"{step.origin.name} is decided by the runtime, and a program buffer runs without it"
            help_ = "leave --target prog out, or decide by one input: WHEN DOOR ON"
            return Diagnostic("Y1105", message, step.origin.source, step.origin.span, help_)
    return None


def write(plan: MotionPlan, target: Target, tolerance: Tolerance, memory: Memory) -> Written:
    """Lower a plan, and print it."""
    lowered = lower(plan, target, tolerance)
    emitted = emit(lowered, memory)
    times = {motion.curve.segment for motion in plan.motions}
    ends = sorted({min(times), max(times)}) if times else ()
    return Written(
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
