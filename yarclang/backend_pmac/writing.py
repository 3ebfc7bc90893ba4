"""A motion plan to the text of a program for a Turbo PMAC."""

from __future__ import annotations

from yarclang.backend import Written
from yarclang.backend_pmac.emit import emit, segment_time
from yarclang.backend_pmac.lower import lower
from yarclang.memory import Memory
from yarclang.motion.plan import MotionPlan
from yarclang.pmac.program import LOADING, Target
from yarclang.robot.model import Tolerance
from yarclang.units import MS


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
