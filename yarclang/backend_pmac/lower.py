"""Plan to controller program: sequences of SPLINE1 moves, with the controller's own end pieces counted in."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.backend_pmac.decimals import decimals_for
from yarclang.backend_pmac.guard import Watermarks, watermarks
from yarclang.hir import Array, Gap, Stop
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.pmac.program import Assignment, Command, Moves, PmacProgram, SegmentTime, Target
from yarclang.pmac.variables import ARMED
from yarclang.robot.actuation import counts_per_joint, to_counts
from yarclang.robot.model import Robot, Tolerance
from yarclang.units import MS

_START_SHARE = 0.05
"""A start that is off adds this share of the acceleration limit in the first segment."""


def lower(plan: MotionPlan, target: Target, tolerance: Tolerance) -> PmacProgram:
    """Make the controller program of a plan, printed finely enough for the tolerance of its path."""
    robot = plan.robot
    segments = [motion.curve.segment for motion in plan.motions]
    shortest = min(segments, default=robot.controller.largest_segment)
    marks = watermarks(robot, shortest)
    decimals = max((decimals_for(robot, segment, tolerance) for segment in set(segments)), default=4)
    body = tuple(_body(plan.motions, robot.axis_units, decimals))
    if target == "rotary":
        body = _guarded(body, marks)
    first = segments[0] if segments else shortest
    # the start as it is printed is the start of the motion
    start = _printed(plan.program.start / robot.axis_units, decimals)
    unit = 32 * robot.controller.ixx08
    return PmacProgram(
        target=target,
        coordinate_system=robot.controller.coordinate_system,
        motors=robot.controller.motors,
        axes=robot.controller.axes,
        joint_names=robot.joint_names,
        decimals=decimals,
        start=start,
        start_counts=to_counts(robot, start * robot.axis_units) * unit,
        start_slack=_start_slack(robot, first) * unit,
        rotary_words=marks.words,
        full_lines=marks.full,
        low_lines=marks.low,
        body=body,
        commands=tuple(_commands(plan)),
    )


def _commands(plan: MotionPlan) -> Iterator[Command]:
    for number, step in enumerate(plan.program.steps):
        if isinstance(step, Gap):
            raise ValueError("a program with errors can't be lowered")
        origin = step.origin
        yield Command(number, origin.index or "-", origin.name, origin.span.line)
        if isinstance(step, Stop):
            return


def _body(
    motions: tuple[PlannedMotion, ...], axis_units: Array, decimals: int
) -> Iterator[SegmentTime | Assignment | Moves]:
    """The moves of all motions.

    A sequence ends with the program, or where the segment time changes: there the controller adds the end
    piece, and a start piece to the next sequence, and the last two of the three equal points of a stop
    aren't written. Inside a sequence they are.
    """
    written: float | None = None
    for number, motion in enumerate(motions):
        curve = motion.curve
        if curve.segment != written:
            written = curve.segment
            yield SegmentTime(curve.segment / MS)
        ends = number + 1 == len(motions) or motions[number + 1].curve.segment != curve.segment
        points = curve.points[3:-2] if ends else curve.points[3:]
        yield Moves(motion.step, _printed(points / axis_units, decimals))


def _printed(values: Array, decimals: int) -> Array:
    """As printed; a negative zero becomes a positive one."""
    printed: Array = np.round(values, decimals) + 0.0
    return printed


def _guarded(
    body: tuple[SegmentTime | Assignment | Moves, ...], marks: Watermarks
) -> tuple[SegmentTime | Assignment | Moves, ...]:
    """The body with the guard armed before the first move, and disarmed while the last lines, fewer than would
    count as low, are still ahead. A program that fits between the marks needs no guard: it is loaded as a whole.
    """
    lines = sum(len(item.values) for item in body if isinstance(item, Moves))
    before_disarming = lines - (marks.low + 2)
    if lines <= marks.full + 2:
        return body
    guarded: list[SegmentTime | Assignment | Moves] = []
    armed = False
    for item in body:
        if not isinstance(item, Moves):
            guarded.append(item)
            continue
        if not armed:
            guarded.append(Assignment(ARMED, 1))
            armed = True
        rows = len(item.values)
        if 0 <= before_disarming < rows:
            if before_disarming:
                guarded.append(Moves(item.step, item.values[:before_disarming]))
            guarded.append(Assignment(ARMED, 0))
            guarded.append(Moves(item.step, item.values[before_disarming:]))
        else:
            guarded.append(item)
        before_disarming -= rows
    return tuple(guarded)


def _start_slack(robot: Robot, segment: float) -> Array:
    """How far each motor may be from the start [counts], so that no joint is off by more than what
    adds a small share of its acceleration limit in the first segment.
    """
    joints = _START_SHARE * robot.limits.acceleration * segment**2
    matrix = counts_per_joint(robot)
    slack = np.abs(matrix) @ joints
    share = (joints / (np.abs(np.linalg.inv(matrix)) @ slack)).min()
    allowed: Array = slack * share
    return allowed
