"""Where the motions of a program lead: the path of each, from where the last one ended.

A pose target of a joint motion has several solutions, and which one is taken decides what the Cartesian motions behind it can do. The
nearest is taken first; where a motion that follows can't be done from there, the next ones are tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from yarclang.diagnostics import Collector, Diagnostic
from yarclang.hir import (
    Action,
    ArcMove,
    Array,
    Else,
    EndWhen,
    Gap,
    JointDelta,
    JointGoal,
    JointMove,
    LineMove,
    Motion,
    PoseDelta,
    PoseGoal,
    PoseSplineMove,
    SplineMove,
    Step,
    When,
)
from yarclang.motion import messages
from yarclang.motion.cartesian import CartesianPath, FramePath, along
from yarclang.motion.path import Path
from yarclang.motion.paths.arc import NoArc, arc_through
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.paths.line import line_between
from yarclang.motion.paths.pose_spline import AtConstantSpeed, PoseSpline, through_poses
from yarclang.motion.paths.spline import SplinePath, distinct, through
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.nearest import Unreachable, full_turns, nearest_solutions
from yarclang.robot.model import Robot
from yarclang.units import MM

CartesianMove = LineMove | ArcMove | PoseSplineMove


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """The path of one motion, and the joint positions (k, n) [rad or m] that were chosen for its way-points."""

    path: Path
    waypoints: Array


@dataclass(frozen=True, slots=True)
class _Ways:
    """A WHEN that isn't ended: where the robot stood before it, and where its first way ends, once there is a second."""

    when: When
    before: _Stand
    first: Array | None = None
    parted: bool = False


@dataclass(frozen=True, slots=True)
class _Stand:
    """What is known between two steps: where the robot stands (None: nowhere known), the WHENs around, and the last motion whose
    solution was chosen and decides where the robot stands (None: where it stands was written).
    """

    q: Array | None
    ways: tuple[_Ways, ...] = ()
    choice: int | None = None


@dataclass(slots=True)
class _Done:
    """What came of one step. `broken` says that it can't be done from where the robot stood, though perhaps from elsewhere."""

    before: _Stand
    behind: _Stand
    route: Route | None = None
    found: tuple[Diagnostic, ...] = ()
    broken: bool = False


@dataclass(slots=True)
class Router:
    """Routes the steps of a program one after the other; `done` has what came of each."""

    robot: Robot
    steps: Sequence[Step]
    start: Array
    done: list[_Done] = field(default_factory=list)
    _choices: dict[int, Array] = field(default_factory=dict)
    """What was taken instead of the nearest, by step."""

    def advance(self) -> None:
        """Route the next step; where it can't be done from here, from another solution of an earlier target if one serves."""
        before = self.done[-1].behind if self.done else _Stand(self.start)
        done = self._step(len(self.done), before)
        self.done.append(done)
        if done.broken and before.choice is not None:
            self._choose_otherwise(before.choice)

    def _choose_otherwise(self, chosen: int) -> None:
        """Try the other solutions of step `chosen`, the nearest first, until the steps from there to the last can be done."""
        tried = self.done[chosen:]
        last = len(self.done)
        goal = _last_goal(self.steps[chosen])
        near = self._near(chosen)
        if goal is None or near is None:
            return
        for q in self._solutions(goal, near)[1:]:
            if chosen in self._choices and np.array_equal(q, self._choices[chosen]):
                continue
            had = self._choices.get(chosen)
            self._choices[chosen] = q
            del self.done[chosen:]
            while len(self.done) < last:
                before = self.done[-1].behind if self.done else _Stand(self.start)
                done = self._step(len(self.done), before)
                self.done.append(done)
                if done.broken:
                    break
            else:
                step = self.steps[chosen]
                nearest = tried[0].route.waypoints[-1] if tried[0].route is not None else None
                assert isinstance(step, Motion)
                note = Collector(step.origin.source)
                note.place = step.origin.place
                note.add(
                    *messages.another_configuration(
                        self.robot, step, q, nearest, self.steps[last - 1], tried[-1].found
                    )
                )
                self.done[chosen].found = (*note.found, *self.done[chosen].found)
                return
            self._choices.pop(chosen)
            if had is not None:
                self._choices[chosen] = had
        self.done[chosen:] = tried

    def _near(self, number: int) -> Array | None:
        """To what the solution of the last pose of a motion shall be near."""
        done = self.done[number]
        if done.route is None or len(done.route.waypoints) < 2:
            return done.before.q
        return np.array(done.route.waypoints[-2])

    def _step(self, number: int, before: _Stand) -> _Done:
        step = self.steps[number]
        if isinstance(step, Gap):
            return _Done(before, replace(before, q=None, choice=None))
        findings = Collector(step.origin.source)
        findings.place = step.origin.place
        if isinstance(step, Motion):
            if before.q is None:
                behind = replace(before, q=self._from_anywhere(step, findings), choice=None)
                return _Done(before, behind, None, tuple(findings.found))
            return self._motion(number, step, before, before.q, findings)
        behind = self._flow(step, before, findings) if isinstance(step, Action) else before
        return _Done(before, behind, None, tuple(findings.found))

    def _flow(self, step: Action, stand: _Stand, findings: Collector) -> _Stand:
        """What is known behind a step that doesn't move the robot: something else only at the ways of a WHEN."""
        match step:
            case When():
                return replace(stand, ways=(*stand.ways, _Ways(step, stand)))
            case Else():
                *outer, here = stand.ways
                parted = replace(here, first=stand.q, parted=True)
                return _Stand(here.before.q, (*outer, parted), here.before.choice)
            case EndWhen():
                *outer, ended = stand.ways
                other = ended.first if ended.parted else ended.before.q
                met = stand.q
                if met is None or other is None:
                    met = None
                elif not self._same(met, other):
                    findings.add(*messages.ways_part(self.robot, met, other, ended.when.origin))
                    met = None
                # the solutions that were chosen before are fixed by both ways together
                return _Stand(met, tuple(outer), None)
        return stand

    def _same(self, one: Array, other: Array) -> bool:
        """Whether two joint positions are one for the controller: far below a count."""
        return bool((np.abs(one - other) <= 1e-9 * self.robot.axis_units).all())

    def _motion(self, number: int, step: Motion, before: _Stand, q: Array, findings: Collector) -> _Done:
        """Route one motion from `q` (n,)."""
        choice = before.choice
        broken = False
        path: Path | None
        match step:
            case JointMove():
                end, broken = self._joint_end(number, step, q, findings)
                path = None if end is None else JointPath(q, end)
                waypoints = None if end is None else end[None]
                if not isinstance(step.goal, JointDelta):
                    choice = number if _is_free(step.goal) else None
            case SplineMove():
                path, end, waypoints = self._spline(number, step, q, findings)
                choice = number if _is_free(step.waypoints[-1]) else None
            case LineMove() | ArcMove() | PoseSplineMove():
                path, end, broken = self._cartesian(step, q, findings)
                waypoints = None if end is None else end[None]
        route = None if path is None or waypoints is None else Route(path, waypoints)
        return _Done(before, replace(before, q=end, choice=choice), route, tuple(findings.found), broken)

    def _from_anywhere(self, step: Motion, findings: Collector) -> Array | None:
        """Check what can be checked of a motion from an unknown place: whether its poses can be reached at all."""
        goals = step.waypoints if isinstance(step, SplineMove | PoseSplineMove) else (step.goal,)
        for goal in goals:
            if isinstance(goal, PoseGoal):
                self._solve(goal, self.robot.home, step, findings)
        return goals[-1].q if isinstance(goals[-1], JointGoal) else None

    def _joint_end(
        self, number: int, step: JointMove, stands: Array, findings: Collector
    ) -> tuple[Array | None, bool]:
        """Where a joint motion ends, None where it can't be reached; and whether that is for want of another start."""
        if isinstance(step.goal, JointGoal):
            return step.goal.q, False
        if isinstance(step.goal, JointDelta):
            end = stands + step.goal.dq
            if not self._within_limits(end):
                findings.add(*messages.increments_out_of_limits(self.robot, end, step.origin))
                return None, True
            return end, False
        if number in self._choices:
            return self._choices[number], False
        return self._solve(step.goal, stands, step, findings), False

    def _solve(
        self, goal: PoseGoal, near: Array, step: Motion, findings: Collector, which: str = ""
    ) -> Array | None:
        """The joint position nearest to `near` that takes the moving frame to its goal."""
        near = near if goal.near is None else goal.near
        solved = nearest_solutions(self.robot.chain, self.robot.limits, _flange(goal), near)
        if isinstance(solved, Unreachable):
            findings.add(*messages.unreachable(self.robot, solved, step.origin, which))
            return None
        return np.array(solved.q[0])

    def _solutions(self, goal: PoseGoal, near: Array) -> list[Array]:
        """All solutions within limits with all their full turns, the nearest to `near` first."""
        chain, limits = self.robot.chain, self.robot.limits
        solved = nearest_solutions(chain, limits, _flange(goal), near)
        if isinstance(solved, Unreachable):
            return []
        turns = np.concatenate([full_turns(chain, limits, q) for q in solved.q])
        distance = np.square(turns - near).sum(axis=1)
        return list(turns[np.argsort(np.round(distance, 9), kind="stable")])

    def _cartesian(
        self, step: CartesianMove, stands: Array, findings: Collector
    ) -> tuple[Path | None, Array | None, bool]:
        """The path of a motion of the moving frame, where it ends if that is known, and whether another start might help."""
        goal = step.waypoints[-1] if isinstance(step, PoseSplineMove) else step.goal
        tool = goal.flange_from_moving
        start = tool_poses(self.robot.chain, stands[None], tool)[0]
        if isinstance(goal, PoseDelta):
            goal = _absolute(goal, start)
        frame = self._frame_path(step, start, goal, findings)
        if frame is None:
            return None, None, False
        if frame.length < 1e-12 and frame.angle == 0.0:
            return JointPath(stands, stands), stands, False
        path = along(self.robot.chain, self.robot.limits, tool, frame, stands)
        if isinstance(path, CartesianPath):
            return path, path.end, False
        end = self._solve(goal, stands, step, findings)
        if end is not None:  # the goal can be reached, but not along the path
            findings.add(*messages.broken_path(self.robot, path, frame, step))
        return None, end, path.kind != "reach"

    def _frame_path(
        self, step: CartesianMove, start: Array, goal: PoseGoal, findings: Collector
    ) -> FramePath | None:
        """The path of the moving frame from its pose at the start (4, 4)."""
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
                    findings.add(*messages.half_turn(step.origin, f"at way-point {spline} "))
                    return None
                if spline is None:  # all way-points are where the frame stands
                    return line_between(start, start)
                self._note_swing(spline, step, findings)
                timed = step.timing.speed is not None and spline.slowest > 1e-3 * spline.length > 0.0
                return AtConstantSpeed(spline) if timed else spline

    def _note_swing(self, spline: PoseSpline, step: PoseSplineMove, findings: Collector) -> None:
        """A note where a curve of the moving frame leaves the box round its way-points by much."""
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

    def _spline(
        self, number: int, step: SplineMove, stands: Array, findings: Collector
    ) -> tuple[Path | None, Array | None, Array | None]:
        """The path of a spline, where it ends, and the joint way-points that were chosen."""
        waypoints: list[Array] = []
        near = stands
        for place, goal in enumerate(step.waypoints, 1):
            if place == len(step.waypoints) and number in self._choices:
                q: Array | None = self._choices[number]
            elif isinstance(goal, JointGoal):
                q = goal.q
            else:
                q = self._solve(goal, near, step, findings, f"way-point {place}: ")
            if q is None:
                return None, None, None
            waypoints.append(q)
            near = q
        chosen = np.array(waypoints)
        path = distinct(np.concatenate((stands[None], chosen)))
        if len(path) == 1:
            return JointPath(stands, stands), stands, chosen
        spline = through(path, self.robot.chain.is_prismatic)
        if not self._swings_within_limits(spline, step, findings):
            return None, spline.end, chosen
        return spline, spline.end, chosen

    def _swings_within_limits(self, spline: SplinePath, step: SplineMove, findings: Collector) -> bool:
        """Whether a spline keeps the joint limits all along; a note where it leaves its way-points by much."""
        low, low_at, high, high_at = spline.extremes()
        limits = self.robot.limits
        excess = np.maximum(limits.lower - low, high - limits.upper) / self.robot.axis_units
        joint = int(np.argmax(excess))
        if excess[joint] > 1e-9:
            at = low_at if limits.lower[joint] - low[joint] > high[joint] - limits.upper[joint] else high_at
            findings.add(
                *messages.spline_out_of_limits(self.robot, joint, excess[joint], at[joint], step.origin)
            )
            return False
        swing = (
            np.maximum(spline.waypoints.min(axis=0) - low, high - spline.waypoints.max(axis=0))
            / self.robot.axis_units
        )
        joint = int(np.argmax(swing))
        if swing[joint] > messages.MUCH_SWING:
            below = spline.waypoints[:, joint].min() - low[joint]
            at = low_at if below / self.robot.axis_units[joint] == swing[joint] else high_at
            findings.add(*messages.spline_swings_out(self.robot, joint, swing[joint], at[joint], step.origin))
        return True

    def _within_limits(self, q: Array) -> bool:
        limits, slack = self.robot.limits, 1e-9 * self.robot.axis_units
        return bool(np.all((q >= limits.lower - slack) & (q <= limits.upper + slack)))


def _is_free(goal: object) -> bool:
    """Whether a target has solutions to choose from."""
    return isinstance(goal, PoseGoal) and goal.near is None


def _last_goal(step: Step) -> PoseGoal | None:
    goal = step.waypoints[-1] if isinstance(step, SplineMove) else getattr(step, "goal", None)
    return goal if isinstance(goal, PoseGoal) else None


def _flange(goal: PoseGoal) -> Array:
    """Where the flange stands at a goal, base_from_flange (4, 4)."""
    flange: Array = goal.base_from_moving @ np.linalg.inv(goal.flange_from_moving)
    return flange


def _absolute(delta: PoseDelta, start: Array) -> PoseGoal:
    """The pose (4, 4) to which an increment leads from `start` (4, 4), both of the moving frame in {B}."""
    axes = delta.axes
    if delta.axes_on_flange:
        axes = start[:3, :3] @ delta.flange_from_moving[:3, :3].T @ delta.axes
    pose = np.eye(4)
    pose[:3, 3] = start[:3, 3] + axes @ delta.shift
    pose[:3, :3] = axes @ delta.turn @ axes.T @ start[:3, :3]
    return PoseGoal(pose, delta.flange_from_moving)
