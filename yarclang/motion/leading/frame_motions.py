"""Find the arm's paths for motions of the moving frame: lines, arcs and splines of poses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.diagnostics import Collector
from yarclang.hir import ArcMove, Array, LineMove, PoseDelta, PoseGoal, PoseSplineMove
from yarclang.motion.avoid.lines import EFFORTS, QUICK, find_course
from yarclang.motion.avoid.messages import no_way, way_of_lines
from yarclang.motion.avoid.way import NoWay
from yarclang.motion.cartesian import CartesianPath, FramePath, along
from yarclang.motion.leading import messages
from yarclang.motion.leading.clearing import kept_clear
from yarclang.motion.leading.led import NOWHERE, FrameWay, Led, LineLeg
from yarclang.motion.leading.solving import Solver
from yarclang.motion.paths.arc import NoArc, arc_through
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.paths.line import Line, line_between
from yarclang.motion.paths.pose_spline import AtConstantSpeed, PoseSpline, through_poses
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.inverse import REACHED
from yarclang.robot.kinematics.track import Reason
from yarclang.units import MM

CartesianMove = LineMove | ArcMove | PoseSplineMove


def frame_motion(solver: Solver, step: CartesianMove, stands: Array, findings: Collector) -> Led:
    """Find the arm's path for a motion of the moving frame, from the joint position `stands` (n,) [rad or
    m].
    """
    robot = solver.robot
    tool = moving_frame(step)
    start = tool_poses(robot.chain, stands[None], tool)[0]
    goal = _goal(step, start)
    frame = _frame_path(step, start, goal, findings)
    if frame is None:
        return NOWHERE
    if frame.length < REACHED and frame.angle < REACHED:
        return Led(JointPath(stands, stands), stands, stands[None])
    legs = frame.legs if isinstance(frame, PoseSpline | AtConstantSpeed) else 1
    path = along(robot.chain, robot.limits, tool, frame, stands, legs=legs, reason="any")
    if isinstance(path, CartesianPath):
        path = kept_clear(solver, step, path)
        return Led(path, path.end, path.end[None])
    end = solver.nearest(goal, stands, step, findings)
    if end is None:  # out of reach from any position
        return NOWHERE
    if not path.is_measured:
        reason: Reason = "measured" if solver.measures else "kind"
        path = along(robot.chain, robot.limits, tool, frame, stands, legs=legs, reason=reason)
        assert not isinstance(path, CartesianPath)
    findings.add(*messages.broken_path(robot, path, frame, step))
    return Led(None, end, None, path.kind != "reach")


def avoiding_line(solver: Solver, step: LineMove, stands: Array, findings: Collector) -> Led:
    """Find a line from the joint position `stands` (n,) [rad or m]. If obstacles are on the line, find a
    polyline around them.
    """
    robot, tool = solver.robot, moving_frame(step)
    start = tool_poses(robot.chain, stands[None], tool)[0]
    goal = _goal(step, start)
    line = _frame_path(step, start, goal, findings)
    if line is None:
        return NOWHERE
    assert isinstance(line, Line)
    if line.length < REACHED and line.angle < REACHED:
        return Led(JointPath(stands, stands), stands, stands[None])
    path = along(robot.chain, robot.limits, tool, line, stands, reason="any")
    straight = kept_clear(solver, step, path) if isinstance(path, CartesianPath) else None
    goals: Sequence[Array] = solver.solutions(goal, stands)
    if not goals and straight is None:
        solver.nearest(goal, stands, step, findings)
        return NOWHERE
    efforts = QUICK if solver.is_again else EFFORTS
    course = find_course(solver.room(step), line, straight, stands, goals, efforts, solver.searches)
    if isinstance(course, NoWay):
        end = goals[0] if straight is None else straight.end
        is_blocked = course.start is not None or course.goal is not None
        if straight is None and not is_blocked and course.tries == 0:
            return frame_motion(solver, step, stands, findings)
        findings.add(*no_way(robot, course, step.origin))
        return Led(None, end, None, straight is None and not is_blocked)
    if len(course.paths) > 1:
        findings.add(*way_of_lines(course, step))
    shares = course.shares(robot.limits).tolist()
    legs = tuple(map(LineLeg, course.poses, course.paths, shares))
    end = course.paths[-1].end
    return Led(course.paths[-1], end, end[None], legs=legs)


def frame_way(step: CartesianMove, flange: Array, findings: Collector) -> tuple[FrameWay | None, PoseGoal]:
    """Return the path of the moving frame and its goal, without joint positions.

    If the frame has no path to the goal, None is returned instead of the path, and a finding is added.

    Args:
        step: the motion.
        flange: the flange's pose at the start, base_from_flange (4, 4).
        findings: receives findings about the path.
    """
    tool = moving_frame(step)
    start = flange @ tool
    goal = _goal(step, start)
    frame = _frame_path(step, start, goal, findings)
    return (None if frame is None else FrameWay(frame, tool)), goal


def moving_frame(step: CartesianMove) -> Array:
    """Return the frame that a motion moves, flange_from_moving (4, 4)."""
    return step.goals[-1].flange_from_moving


def _goal(step: CartesianMove, start: Array) -> PoseGoal:
    """Return the goal pose of a motion. If the goal is an increment, it is added to the moving frame's pose
    `start` (4, 4).
    """
    goal = step.goals[-1]
    return _absolute(goal, start) if isinstance(goal, PoseDelta) else goal


def _frame_path(step: CartesianMove, start: Array, goal: PoseGoal, findings: Collector) -> FramePath | None:
    """Return the path of the moving frame from its pose `start` (4, 4). If there is none, return None and add
    a finding.
    """
    match step:
        case LineMove():
            line = line_between(start, goal.base_from_moving)
            if line is None:
                findings.add(*messages.half_turn(step.origin))
            return line
        case ArcMove():
            arc = arc_through(start, step.via, goal.base_from_moving)
            if not isinstance(arc, NoArc):
                return arc
            findings.add(*messages.no_arc(arc, step.origin))
            return None
        case PoseSplineMove():
            spline = through_poses(
                np.array([start, *(waypoint.base_from_moving for waypoint in step.waypoints)])
            )
            if isinstance(spline, int):
                findings.add(*messages.half_turn(step.origin, f"at waypoint {spline} "))
                return None
            if spline is None:  # all waypoints are equal to the frame's present pose
                return line_between(start, start)
            _note_swing(spline, step, findings)
            timed = step.timing.speed is not None and spline.slowest > 1e-3 * spline.length > 0.0
            return AtConstantSpeed(spline) if timed else spline


def _note_swing(spline: PoseSpline, step: PoseSplineMove, findings: Collector) -> None:
    """Add a note if a spline of the moving frame swings far out of the box around its waypoints."""
    low, low_at, high, high_at = spline.positions.extremes()
    points = spline.positions.values
    swing = np.maximum(points.min(axis=0) - low, high - points.max(axis=0))
    axis = int(np.argmax(swing))
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    if swing[axis] > max(messages.MUCH_SWING * MM, messages.MUCH_OF_BOX * size):
        at = low_at if points[:, axis].min() - low[axis] == swing[axis] else high_at
        findings.add(
            *messages.curve_swings_out("xyz"[axis], float(swing[axis]), float(at[axis]), step.origin)
        )


def _absolute(delta: PoseDelta, start: Array) -> PoseGoal:
    """Return the pose (4, 4) of the moving frame in {B} after an increment from its pose `start` (4, 4)."""
    axes = delta.axes
    if delta.axes_on_flange:
        axes = start[:3, :3] @ delta.flange_from_moving[:3, :3].T @ delta.axes
    pose = np.eye(4)
    pose[:3, 3] = start[:3, 3] + axes @ delta.shift
    # The rotation is given in `axes`: convert it to {B}, and apply it to the present orientation.
    pose[:3, :3] = axes @ delta.turn @ axes.T @ start[:3, :3]
    return PoseGoal(pose, delta.flange_from_moving)
