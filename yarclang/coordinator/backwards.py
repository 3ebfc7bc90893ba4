"""Reversal of the last motions: the robot moves along the same paths from end to start.

The reversed motions form a program, which is planned and certified like any other program.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from yarclang.decisions import only_holding
from yarclang.diagnostics import Diagnostic
from yarclang.hir import (
    ArcMove,
    Array,
    AvoidMove,
    JointGoal,
    JointMove,
    LineMove,
    Motion,
    Origin,
    PoseDelta,
    PoseGoal,
    PoseSplineMove,
    Program,
    SplineMove,
    TimedMove,
    Timetable,
)
from yarclang.motion.plan import MotionPlan
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span
from yarclang.transforms import constant


@dataclass(frozen=True, slots=True, eq=False)
class Passed:
    """A motion that was carried out completely or in part. Positions are joint positions [rad or m].

    `step` is the motion, and `waypoints` (k, n) are the joint positions that the planner chose for its goals.
    `start` and `end` (n,) are the robot's positions before and after the motion, `middle` (n,) its position
    at half of the motion's time. `whole` is True if the motion reached its end. `flows` is True if the robot
    didn't stop between this motion and the next one.
    """

    step: Motion
    waypoints: Array
    start: Array
    middle: Array
    end: Array
    whole: bool
    flows: bool


def passed(plan: MotionPlan, stands: Array | None = None, progress: float = 0.0) -> tuple[Passed, ...]:
    """Return the motions of a plan that were carried out, completely or in part.

    Args:
        plan: the plan.
        stands: (n,) joint positions at which the robot was stopped on its path [rad or m]; None if it reached
            the end of the plan.
        progress: time of the plan at which the robot was stopped [s].
    """
    passed_motions: list[Passed] = []
    begins, ends = plan.begins, plan.ends
    begin = plan.program.start
    for number, motion in enumerate(plan.motions):
        step = plan.program.steps[motion.step]
        assert isinstance(step, Motion)
        flows = motion.flows
        if stands is not None and progress <= ends[number]:
            middle = plan.sample(np.array([(begins[number] + progress) / 2.0]))[0][0]
            passed_motions.append(Passed(step, motion.waypoints, begin, middle, stands, False, False))
            return tuple(passed_motions)
        end = motion.waypoints[-1]
        middle = plan.sample(np.array([(begins[number] + ends[number]) / 2.0]))[0][0]
        passed_motions.append(Passed(step, motion.waypoints, begin, middle, end, True, flows))
        begin = end
    return tuple(passed_motions)


def last_group(motions: tuple[Passed, ...]) -> tuple[Passed, ...]:
    """Return the last motions of a list that the robot carried out without a stop between them."""
    first = len(motions) - 1
    while first > 0 and motions[first - 1].flows:
        first -= 1
    return motions[first:]


def known_behind_searches(motions: Sequence[Passed]) -> list[Passed]:
    """Return the motions at the end of a list that the robot can drive back along their own paths.

    Two kinds of motions can't be driven back, nor can any motion before them:

    - A search and the motion after it. A search may have ended anywhere on its line, but the plan of the next
      motion begins at the end of the line. On the way to this end, the robot might hit the object that ended
      the search.
    - A motion to a goal that is shifted at run time, and the relative motions after it. The shift isn't known
      in the plan, so the planned path isn't the path that the robot took.

    Args:
        motions: motions that were carried out, in order. A search that was stopped on its own line can be
            driven back, because the robot returns along this line.
    """
    first_known, is_away = 0, False
    for number, motion in enumerate(motions):
        step = motion.step
        shifts = any(isinstance(goal, PoseGoal | PoseDelta) and goal.shifted for goal in step.goals)
        if shifts or is_away:
            # A relative motion from a shifted position ends at a shifted position.
            is_away = shifts or not isinstance(step.end, JointGoal | PoseGoal)
            first_known = number + 1
        if motion.whole and isinstance(step, JointMove | LineMove) and step.search is not None:
            first_known = number + 2
    return list(motions[first_known:])


def backwards(robot: Robot, group: tuple[Passed, ...], program: Program) -> Program | Diagnostic:
    """Build a program that drives a group of motions back along their paths.

    Args:
        robot: the robot.
        group: motions between which the robot doesn't stop, in the order in which they were carried out.
        program: program that contains the motions. Its cell is also that of the new program.

    Returns:
        The new program; a finding instead if the robot can't go back along the same path.
    """
    steps: list[Motion] = []
    blends = [one.step.blend if one.flows else None for one in group[:-1]]
    for one, blend in zip(reversed(group), [*reversed(blends), None], strict=True):
        step = _backwards(robot, one)
        if isinstance(step, Diagnostic):
            return step
        steps.append(replace(step, origin=_origin(one.step, program.source), blend=blend))
    return Program(
        program.source, group[-1].end, tuple(steps), (), program.cell, watches=only_holding(program.watches)
    )


def _backwards(robot: Robot, passed_motion: Passed) -> Motion | Diagnostic:
    step = passed_motion.step
    match step:
        case JointMove():
            return replace(step, goal=JointGoal(passed_motion.start))
        case AvoidMove() if len(passed_motion.waypoints) == 1:
            return JointMove(
                step.origin, JointGoal(passed_motion.start), step.profile, step.timing, step.tolerance
            )
        case AvoidMove() if passed_motion.whole:
            back = tuple(JointGoal(q) for q in (*passed_motion.waypoints[-2::-1], passed_motion.start))
            return SplineMove(step.origin, back, step.profile, step.timing, step.tolerance)
        case LineMove(goal=goal):
            return replace(step, goal=_pose(robot, passed_motion.start, goal.flange_from_moving))
        case ArcMove(goal=goal, via=via):
            moving = goal.flange_from_moving
            through = (
                via
                if passed_motion.whole
                else tool_poses(robot.chain, passed_motion.middle[None], moving)[0, :3, 3]
            )
            return replace(step, via=through, goal=_pose(robot, passed_motion.start, moving))
        case SplineMove() if passed_motion.whole:
            places = [JointGoal(q) for q in (*passed_motion.waypoints[-2::-1], passed_motion.start)]
            return replace(step, waypoints=tuple(places))
        case TimedMove(table=table) if passed_motion.whole:
            return replace(step, table=_turned(table, passed_motion.start))
        case PoseSplineMove(waypoints=waypoints) if passed_motion.whole:
            first = _pose(robot, passed_motion.start, waypoints[0].flange_from_moving)
            return replace(step, waypoints=(*waypoints[-2::-1], first))
    kind = "a timetable" if isinstance(step, TimedMove) else "a spline"
    what = f"the robot was stopped within {step.origin.name}: the rest of {kind} would be another curve"
    return Diagnostic("Y1614", what, help="move back with a new command, MOVEJ or MOVEL")


def _turned(table: Timetable, start: Array) -> Timetable:
    """Return a timetable of joint positions in reverse: it begins at the last row and ends at the joint
    positions `start` (n,) [rad or m], from which the original began.
    """
    rows = slice(int(table.begins), None)
    rest = np.zeros((1, len(start)))
    whole = np.concatenate(([0.0], table.times[rows]))
    positions = np.concatenate((start[None], table.positions[rows]))
    velocities, accelerations = table.velocities, table.accelerations
    if velocities is not None:
        velocities = constant(-np.concatenate((rest, velocities[rows]))[::-1])
    if accelerations is not None:
        first = accelerations[:1] if table.begins else rest
        accelerations = constant(np.concatenate((first, accelerations[rows]))[::-1])
    return Timetable(constant(whole[-1] - whole[::-1]), constant(positions[::-1]), velocities, accelerations)


def _pose(robot: Robot, q: Array, flange_from_moving: Array) -> PoseGoal:
    return PoseGoal(tool_poses(robot.chain, q[None], flange_from_moving)[0], flange_from_moving)


def _origin(step: Motion, source: SourceFile) -> Origin:
    origin = step.origin
    span = origin.span if origin.source == source else Span.on_line(1, 1, 2)
    return Origin(origin.index, origin.name, origin.source, span)
