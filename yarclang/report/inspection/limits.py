"""Compute which limits of the robot determine the duration of a motion, where on its path they are reached,
and the shortest possible duration.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Motion, Program, TimedMove
from yarclang.motion.curve import knot_values
from yarclang.motion.limits import Demand, bounds_of
from yarclang.motion.plan import PlannedMotion
from yarclang.motion.profile import load_profile
from yarclang.pipeline.stages import Request, plan_program
from yarclang.report.inspection.way import alone
from yarclang.robot.model import Array, Robot

_ORDERS = {"velocity": 1, "motor speed": 1, "acceleration": 2, "jerk": 3}
_TRIALS = 20


@frozen
class Limit:
    """The share of one of the robot's limits that a motion uses.

    Attributes:
        kind: kind of the limit.
        whose: joint or motor.
        share: largest share of the limit that the motion uses; 1 is the most that is allowed.
        time: time of the largest share, from the start of the motion [s].
        s: progress along the path at that time, from 0 to 1.
    """

    kind: str
    whose: str
    share: float
    time: float
    s: float


@frozen
class Pace:
    """The limits that determine the duration of a motion.

    Attributes:
        limits: uses of the robot's limits, the largest share first.
        shortest: shortest possible duration [s]. None for a motion with a timetable, for a motion that begins
            or ends without a stop, and if no duration is possible.
    """

    limits: tuple[Limit, ...]
    shortest: float | None

    @property
    def is_shortest(self) -> bool:
        """True if the motion uses more than 98 % of one of the limits."""
        return bool(self.limits) and self.limits[0].share > 1.0 - 0.02


def pace_of(
    program: Program, step: Motion, start: Array, motion: PlannedMotion, request: Request, *, flows: bool
) -> Pace:
    """Compute what limits the duration of a planned motion.

    Args:
        program: program of the step.
        step: the motion.
        start: (n,) start of the motion [rad or m].
        motion: the planned motion.
        request: settings with which it was planned.
        flows: True if the motion begins or ends without a stop. Its chain of motions then determines its
            time, and no shortest duration is computed.
    """
    curve, robot = motion.curve, request.robot
    bounds = bounds_of(robot).reduced(step.timing.share, step.timing.ramp)
    has_jerk_limit = load_profile(motion.profile).has_jerk_limit
    limits = [
        _limit(robot, motion, demand)
        for demand in bounds.demands(curve.points)
        if has_jerk_limit or demand.kind != "jerk"
    ]
    limits.sort(key=lambda one: -one.share)
    has_time_given = flows or isinstance(step, TimedMove)
    return Pace(tuple(limits), None if has_time_given else _shortest(program, step, start, request))


def _limit(robot: Robot, motion: PlannedMotion, demand: Demand) -> Limit:
    curve = motion.curve
    order = _ORDERS[demand.kind]
    # A difference of order r that begins at control point i belongs to knot i + r/2 - 1: control point i
    # belongs to knot i - 1.
    knot = min(max(demand.at + order / 2.0 - 1.0, 0.0), float(curve.segments))
    s = float(np.interp(knot, np.arange(curve.segments + 1), knot_values(curve.law)))
    of_motor = demand.kind == "motor speed"
    whose = f"motor {robot.controller.motors[demand.row]}" if of_motor else robot.joint_names[demand.row]
    share = float((demand.segment / curve.segment) ** order)
    return Limit(demand.kind, whose, share, knot * curve.segment, s)


def _shortest(program: Program, step: Motion, start: Array, request: Request) -> float | None:
    """Return the shortest possible time within the command's shares of the limits [s]."""
    quickest = replace(alone(step), timing=replace(step.timing, duration=None, share=1.0, speed=None))
    planned = plan_program(replace(program, start=start, steps=(quickest,)), request)
    if planned.value is None or not planned.value.motions:
        return None
    duration = planned.value.motions[0].curve.duration
    for _ in range(_TRIALS):
        # round up to whole milliseconds, so that the duration is still possible as it is printed
        duration = math.ceil(duration * 1e3 - 1e-6) / 1e3
        given = replace(quickest, timing=replace(quickest.timing, duration=duration))
        if plan_program(replace(program, start=start, steps=(given,)), request).value is not None:
            return duration
        duration *= 1.002
    return None
