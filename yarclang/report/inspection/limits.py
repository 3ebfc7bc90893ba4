"""What limits the time of a motion, where on its path, and the shortest time that works."""

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
    """How near a motion comes to a limit: `share` of it (1 is all that may be used), of `whose` joint or motor, `time` [s] behind
    the start of the motion, at a share `s` of its way.
    """

    kind: str
    whose: str
    share: float
    time: float
    s: float


@frozen
class Pace:
    """What limits the time of a motion: the limits, the nearest first, and the shortest time that works [s] (None: none does, or the motion has none of its own)."""

    limits: tuple[Limit, ...]
    shortest: float | None

    @property
    def is_shortest(self) -> bool:
        """Whether the first of the limits is used up."""
        return bool(self.limits) and self.limits[0].share > 1.0 - 0.02


def pace_of(
    program: Program, step: Motion, start: Array, motion: PlannedMotion, request: Request, *, flows: bool
) -> Pace:
    """Look at the limits of a planned motion.

    Args:
        program: the step's.
        step: the motion.
        start: (n,) where it begins [rad or m].
        motion: as it is planned.
        request: how it was planned.
        flows: True if it begins or ends without a stop: its time is that of its chain, so that no shortest time is looked for.
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
    # a difference of order r from control point i on belongs to knots i + r/2 - 1 (points stand one knot ahead)
    knot = min(max(demand.at + order / 2.0 - 1.0, 0.0), float(curve.segments))
    s = float(np.interp(knot, np.arange(curve.segments + 1), knot_values(curve.law)))
    of_motor = demand.kind == "motor speed"
    whose = f"motor {robot.controller.motors[demand.row]}" if of_motor else robot.joint_names[demand.row]
    share = float((demand.segment / curve.segment) ** order)
    return Limit(demand.kind, whose, share, knot * curve.segment, s)


def _shortest(program: Program, step: Motion, start: Array, request: Request) -> float | None:
    """The shortest time that works under the whole limits that the command may use [s]."""
    quickest = replace(alone(step), timing=replace(step.timing, duration=None, share=1.0, speed=None))
    planned = plan_program(replace(program, start=start, steps=(quickest,)), request)
    if planned.value is None or not planned.value.motions:
        return None
    duration = planned.value.motions[0].curve.duration
    for _ in range(_TRIALS):
        # few digits, and it works when it is given
        duration = math.ceil(duration * 1e3 - 1e-6) / 1e3
        given = replace(quickest, timing=replace(quickest.timing, duration=duration))
        if plan_program(replace(program, start=start, steps=(given,)), request).value is not None:
            return duration
        duration *= 1.002
    return None
