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
"""Smallest ratio of a motion's time to the shortest possible time for a remark."""

SHORT = 5.0
"""Smallest motion time for a remark [s]."""

_NO_TIME = 1e-3
"""Smallest value of the shortest possible time for a remark [s]. A shorter motion goes nowhere, which is
another finding.
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
                f"this motion takes {given:g} s and could be done in {shortest:.2g} s: "
                f"{given / shortest:.0f} times as long"
            )
            yield remark_at(
                step.origin,
                message,
                "check the time and its unit; [MIN] or [50%] let the limits decide, [V 50] the speed of "
                "the tool",
            )


RULE = Rule(
    Finding(
        "Y0611",
        "slow-motion",
        "note",
        "a motion takes more than 20 times as long as it has to",
        "A time that is much too long is often a time in the wrong unit, or the old time of a longer "
        "way, and costs time in every cycle. If the slow motion is intended, for a weld or a glue line, "
        "use a speed such as [V 10] instead: the time then follows from the way.",
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
