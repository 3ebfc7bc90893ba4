"""Find the paths of motions in joint space: straight ones, splines, timetables, and paths around
obstacles.
"""

from __future__ import annotations

from itertools import islice

import numpy as np

from yarclang.diagnostics import Collector
from yarclang.hir import Array, AvoidMove, JointDelta, JointGoal, JointMove, PoseGoal, SplineMove, TimedMove
from yarclang.motion.avoid.messages import configuration_without_way, no_way, way_round
from yarclang.motion.avoid.way import OTHERS, QUICK, NoWay, Way, find_way
from yarclang.motion.leading import messages
from yarclang.motion.leading.led import NOWHERE, Led
from yarclang.motion.leading.solving import Solver, is_free
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.paths.spline import SplinePath, distinct, through
from yarclang.motion.paths.timed import along
from yarclang.progress import go_on
from yarclang.robot.model import Robot

_FEWEST_TOGETHER, _MOST_TOGETHER = 32, 1_024
"""Smallest and largest number of a spline's poses for which inverse kinematics is solved together."""

_CONFIGURATIONS = 3
"""Largest number of inverse-kinematics solutions of a pose to which a path is searched for."""


def joint_motion(
    solver: Solver, step: JointMove, stands: Array, findings: Collector, choice: Array | None = None
) -> Led:
    """Find the path of a straight motion in joint space from `stands` (n,) [rad or m].

    `choice` (n,) is the inverse-kinematics solution for the goal pose; None to choose the nearest one.
    """
    if isinstance(step.goal, JointDelta):
        end: Array | None = stands + step.goal.dq
        assert end is not None
        if not _within_limits(solver.robot, end):
            findings.add(*messages.increments_out_of_limits(solver.robot, end, step.origin))
            return Led(None, None, None, broken=True)
    else:
        end = _end(solver, step, step.goal, stands, findings, choice)
    return NOWHERE if end is None else Led(JointPath(stands, end), end, end[None])


def avoiding_motion(
    solver: Solver, step: AvoidMove, stands: Array, findings: Collector, choice: Array | None = None
) -> Led:
    """Find the path of a joint motion around obstacles.

    The inverse-kinematics solutions of a goal pose are tried one after the other, the nearest first, until a
    path is found.
    """
    end = _end(solver, step, step.goal, stands, findings, choice)
    if end is None or any(one.is_error for one in findings.found):
        return Led(None, end, None)
    room = solver.room(step)
    way = find_way(room, stands, end, efforts=QUICK if solver.is_again else None, searches=solver.searches)
    if isinstance(way, NoWay) and way.start is None and choice is None and isinstance(step.goal, PoseGoal):
        others = solver.others(step.goal, stands, step) if is_free(step.goal) else iter(())
        for other in islice(others, _CONFIGURATIONS - 1):
            way_to_other = find_way(
                room, stands, other, efforts=QUICK if solver.is_again else OTHERS, searches=solver.searches
            )
            if isinstance(way_to_other, Way):
                findings.add(*configuration_without_way(solver.robot, step, other, end, way))
                end, way = other, way_to_other
                break
    if isinstance(way, NoWay):
        findings.add(*no_way(solver.robot, way, step.origin))
        return Led(None, end, None)
    if way.is_straight:
        return Led(JointPath(stands, end), end, end[None])
    findings.add(*way_round(solver.robot, way, step))
    points = distinct(np.concatenate((stands[None], way.waypoints)))
    return Led(through(points, solver.robot.chain.is_prismatic), end, way.waypoints)


def _end(
    solver: Solver,
    step: JointMove | AvoidMove,
    goal: JointGoal | PoseGoal,
    stands: Array,
    findings: Collector,
    choice: Array | None,
) -> Array | None:
    if isinstance(goal, JointGoal):
        return goal.q
    return choice if choice is not None else solver.chosen(goal, stands, step, findings)


def spline_motion(
    solver: Solver, step: SplineMove, stands: Array, findings: Collector, choice: Array | None = None
) -> Led:
    """Find the path of a spline in joint space.

    `choice` (n,) is the inverse-kinematics solution for its last pose; None to choose the nearest one.
    """
    waypoints: list[Array] = []
    near, together = stands, _FEWEST_TOGETHER
    while (place := len(waypoints) + 1) <= len(step.waypoints):
        goal = step.waypoints[place - 1]
        alike = _alike(step, len(waypoints), together)
        if len(alike) >= _FEWEST_TOGETHER:
            go_on()
            found = solver.chosen_in_turn(alike, near, step)
            # As long as no waypoint needs a decision, solve twice as many together the next time.
            together = min(2 * together, _MOST_TOGETHER) if len(found) == len(alike) else _FEWEST_TOGETHER
            if len(found):
                waypoints += list(found)
                near = found[-1]
                continue
        if place == len(step.waypoints) and choice is not None:
            q: Array | None = choice
        elif isinstance(goal, JointGoal):
            q = goal.q
        else:
            q = solver.chosen(goal, near, step, findings, f"waypoint {place}: ")
        if q is None:
            return NOWHERE
        waypoints.append(q)
        near = q
    chosen = np.array(waypoints)
    path = distinct(np.concatenate((stands[None], chosen)))
    if len(path) == 1:
        return Led(JointPath(stands, stands), stands, chosen)
    spline = through(path, solver.robot.chain.is_prismatic)
    if not _swings_within_limits(solver.robot, spline, step, findings):
        return Led(None, spline.end, chosen)
    return Led(spline, spline.end, chosen)


def timed_motion(solver: Solver, step: TimedMove, stands: Array, findings: Collector) -> Led:
    """Find the path of a timetable from `stands` (n,) [rad or m].

    If the timetable has a row at time 0, its joint position must equal `stands`.
    """
    robot, table = solver.robot, step.table
    last = table.positions[-1]
    if table.begins:
        off = np.abs(table.positions[0] - stands)
        if (off > step.within).any():
            findings.add(*messages.table_begins_elsewhere(robot, table.positions[0], stands, step))
            return Led(None, last, None, broken=True)
    path = along(step.asked, stands)
    chosen = table.positions[int(table.begins) :]
    low, low_at, high, high_at = path.extremes()
    limits = robot.limits
    excess = np.maximum(limits.lower - low, high - limits.upper) / robot.axis_units
    joint = int(np.argmax(excess))
    if excess[joint] > 1e-9:
        at = low_at if limits.lower[joint] - low[joint] > high[joint] - limits.upper[joint] else high_at
        findings.add(*messages.spline_out_of_limits(robot, joint, excess[joint], at[joint], step.origin))
        return Led(None, last, chosen)
    return Led(path, last, chosen)


def _alike(step: SplineMove, begin: int, most: int) -> list[PoseGoal]:
    """Return up to `most` consecutive waypoints whose inverse kinematics can be solved together, from number
    `begin` (counted from 0) on.

    They are poses of one frame. The last waypoint is never among them.
    """
    alike: list[PoseGoal] = []
    for goal in step.waypoints[begin : min(begin + most, len(step.waypoints) - 1)]:
        if not isinstance(goal, PoseGoal) or goal.near is not None:
            break
        if alike and not np.array_equal(goal.flange_from_moving, alike[0].flange_from_moving):
            break
        alike.append(goal)
    return alike


def _swings_within_limits(robot: Robot, spline: SplinePath, step: SplineMove, findings: Collector) -> bool:
    """Return True if a spline stays within joint limits everywhere.

    A note is added if it swings far beyond its waypoints.
    """
    low, low_at, high, high_at = spline.extremes()
    limits = robot.limits
    excess = np.maximum(limits.lower - low, high - limits.upper) / robot.axis_units
    joint = int(np.argmax(excess))
    if excess[joint] > 1e-9:
        at = low_at if limits.lower[joint] - low[joint] > high[joint] - limits.upper[joint] else high_at
        findings.add(*messages.spline_out_of_limits(robot, joint, excess[joint], at[joint], step.origin))
        return False
    swing = (
        np.maximum(spline.waypoints.min(axis=0) - low, high - spline.waypoints.max(axis=0)) / robot.axis_units
    )
    joint = int(np.argmax(swing))
    if swing[joint] > messages.MUCH_SWING:
        below = spline.waypoints[:, joint].min() - low[joint]
        at = low_at if below / robot.axis_units[joint] == swing[joint] else high_at
        findings.add(*messages.spline_swings_out(robot, joint, swing[joint], at[joint], step.origin))
    return True


def _within_limits(robot: Robot, q: Array) -> bool:
    limits, slack = robot.limits, 1e-9 * robot.axis_units
    return bool(np.all((q >= limits.lower - slack) & (q <= limits.upper + slack)))
