"""Find a motion that takes much longer than necessary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from yarclang.findings import Finding
from yarclang.hir import Motion, TimedMove
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at
from yarclang.motion.limits import bounds_of
from yarclang.motion.plan import MotionPlan
from yarclang.motion.profile import load_profile
from yarclang.motion.zones import slow_zones

MANY = 20.0
"""A motion gets a remark if its time is more than this many times the shortest possible time."""

SHORT = 5.0
"""A motion with a shorter time than this gets no remark [s]."""

_NO_TIME = 1e-3
"""If the shortest possible time of a motion is not above this, the motion gets no remark [s]. Such a motion
doesn't move the robot; another rule reports this.
"""


def _look(plan: MotionPlan, around: Surroundings) -> Iterator[Remark]:
    limits = bounds_of(around.robot)
    for motion in plan.motions:
        step = plan.program.steps[motion.step]
        assert isinstance(step, Motion)
        given = step.timing.duration
        # The author of a timetable has chosen its times.
        if given is None or given < SHORT or isinstance(step, TimedMove):
            continue
        bounds = limits if load_profile(motion.profile).has_jerk_limit else limits.without_jerk()
        bounds = replace(bounds, zones=slow_zones(around.robot, plan.program.cell, step))
        # The control points don't depend on the segment time: compute the shortest segment time for them.
        needed = max(demand.segment for demand in bounds.demands(motion.curve.points))
        shortest = motion.curve.duration * needed / motion.curve.segment
        if _NO_TIME < shortest < given / MANY:
            message = (
                f"this motion takes {given:g} s, {given / shortest:.0f} times its shortest time of "
                f"{shortest:.2g} s"
            )
            yield remark_at(
                step.origin,
                message,
                "correct the time or its unit; or give [MIN] or [50%] for a share of the limits, [V 50] "
                "for a speed",
            )


RULE = Rule(
    Finding(
        "Y0611",
        "slow-motion",
        "note",
        "a motion takes more than 20 times its shortest time",
        "A motion time that is much too long is often in the wrong unit, or is left over from an earlier, "
        "longer path. It costs time in every cycle. If a slow motion is intended, for a weld or a glue "
        "line, use a speed such as [V 10] instead: the time then follows from the length of the path.",
        "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,min)",
        "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)",
    ),
    MotionPlan,
    _look,
    valid=(
        "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)",
        "P0010 MOVEJ 90 0 0 0 0 0 [20] (deg,s)",
        "P0010 MOVEJ 1 0 0 0 0 0 [50%] (deg)",
    ),
    invalid=("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,min)", "P0010 MOVEJ_TOPP 1 0 0 0 0 0 [30] (deg,s)"),
)
