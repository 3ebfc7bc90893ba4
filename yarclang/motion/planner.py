"""A checked program to a plan: one motion after the other, from where the last one ended."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from yarclang.diagnostics import Collector, Diagnostic, Result
from yarclang.hir import (
    Action,
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
    Program,
    SplineMove,
    Stop,
    When,
)
from yarclang.motion import messages
from yarclang.motion.curve import Curve
from yarclang.motion.fit import NotHeld, TooFast, TooLong, fit
from yarclang.motion.limits import Bounds, Grid, bounds_of
from yarclang.motion.path import Path
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.paths.line import LinePath, along, line_between
from yarclang.motion.paths.spline import SplinePath, distinct, through
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.motion.profile import load_profile
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.nearest import Unreachable, nearest_solutions
from yarclang.robot.kinematics.track import Broken
from yarclang.robot.model import Robot, Tolerance


@dataclass(frozen=True, slots=True)
class Settings:
    """How to plan: the segment times that the controller takes, the tolerance, and who wants to hear of progress.

    `progress` is called with the number of steps done.
    """

    grid: Grid
    tolerance: Tolerance
    progress: Callable[[int], None] | None = None


def plan(program: Program, robot: Robot, settings: Settings) -> Result[MotionPlan]:
    """Plan all motions of a program.

    Returns:
        The plan, or None where a motion can't be done. After an error the planning goes on
        from where the robot would stand, as far as that is known, so that each fault is found.
    """
    planner = _Planner(robot, settings, bounds_of(robot))
    motions: list[PlannedMotion] = []
    diagnostics: list[Diagnostic] = []
    complete = True
    stands: Array | None = program.start
    ways: list[_Ways] = []
    for number, step in enumerate(program.steps):
        if settings.progress is not None:
            settings.progress(number)
        if isinstance(step, Stop):
            break
        if isinstance(step, Gap):
            complete, stands = False, None
            continue
        findings = Collector(step.origin.source)
        findings.place = step.origin.place
        if not isinstance(step, Motion):
            stands = planner.flow(step, stands, ways, findings)
            diagnostics += findings.found
            complete &= not findings.found
            continue
        planned, stands = planner.motion(number, step, stands, findings)
        diagnostics += findings.found
        complete &= planned is not None
        if planned is not None:
            motions.append(planned)
    return Result(MotionPlan(program, robot, tuple(motions)) if complete else None, tuple(diagnostics))


@dataclass(slots=True)
class _Ways:
    """A WHEN that isn't ended: where the robot stood before it, and where its first way ends, once there is a second."""

    when: When
    before: Array | None
    first: Array | None = None
    parted: bool = False


@dataclass(slots=True)
class _Planner:
    robot: Robot
    settings: Settings
    bounds: Bounds

    def flow(
        self, step: Action, stands: Array | None, ways: list[_Ways], findings: Collector
    ) -> Array | None:
        """Where the robot stands behind a step that doesn't move it: elsewhere only at the ways of a WHEN."""
        match step:
            case When():
                ways.append(_Ways(step, stands))
            case Else():
                ways[-1].first, ways[-1].parted = stands, True
                return ways[-1].before
            case EndWhen():
                ended = ways.pop()
                other = ended.first if ended.parted else ended.before
                if stands is None or other is None:
                    return None
                if not self._same(stands, other):
                    findings.add(*messages.ways_part(self.robot, stands, other, ended.when.origin))
                    return None
        return stands

    def _same(self, one: Array, other: Array) -> bool:
        """Whether two joint positions are one for the controller: far below a count."""
        return bool((np.abs(one - other) <= 1e-9 * self.robot.axis_units).all())

    def motion(
        self, number: int, step: Motion, stands: Array | None, findings: Collector
    ) -> tuple[PlannedMotion | None, Array | None]:
        """Plan one motion from `stands` (None: not known).

        Returns:
            The motion, and where the robot stands behind it; None each where that isn't known.
        """
        if stands is None:
            return None, self._from_anywhere(step, findings)
        match step:
            case JointMove():
                end = self._joint_end(step, stands, findings)
                path: Path | None = None if end is None else JointPath(stands, end)
                waypoints = None if end is None else end[None]
            case LineMove():
                path, end = self._line(step, stands, findings)
                waypoints = None if end is None else end[None]
            case SplineMove():
                path, end, waypoints = self._spline(step, stands, findings)
        if path is None or waypoints is None:
            return None, end
        curve = self._curve(step, path, findings)
        if curve is None:
            return None, end
        return PlannedMotion(number, path, step.profile, curve, waypoints), curve.points[-1]

    def _from_anywhere(self, step: Motion, findings: Collector) -> Array | None:
        """Check what can be checked of a motion from an unknown place: whether its poses can be reached at all."""
        goals = step.waypoints if isinstance(step, SplineMove) else (step.goal,)
        for goal in goals:
            if isinstance(goal, PoseGoal):
                self._solve(goal, self.robot.home, step, findings)
        return goals[-1].q if isinstance(goals[-1], JointGoal) else None

    def _joint_end(self, step: JointMove, stands: Array, findings: Collector) -> Array | None:
        """Where a joint motion ends; None where it can't be reached."""
        if isinstance(step.goal, JointGoal):
            return step.goal.q
        if isinstance(step.goal, JointDelta):
            end = stands + step.goal.dq
            if not self._within_limits(end):
                findings.add(*messages.increments_out_of_limits(self.robot, end, step.origin))
                return None
            return end
        return self._solve(step.goal, stands, step, findings)

    def _solve(
        self, goal: PoseGoal, near: Array, step: Motion, findings: Collector, which: str = ""
    ) -> Array | None:
        """The joint position nearest to `near` that takes the moving frame to its goal."""
        flange = goal.base_from_moving @ np.linalg.inv(goal.flange_from_moving)
        near = near if goal.near is None else goal.near
        solved = nearest_solutions(self.robot.chain, self.robot.limits, flange, near)
        if isinstance(solved, Unreachable):
            findings.add(*messages.unreachable(self.robot, solved, step.origin, which))
            return None
        return np.array(solved.q[0])

    def _line(
        self, step: LineMove, stands: Array, findings: Collector
    ) -> tuple[LinePath | JointPath | None, Array | None]:
        """The path of a straight motion, and where it ends if that is known."""
        tool = step.goal.flange_from_moving
        start = tool_poses(self.robot.chain, stands[None], tool)[0]
        goal = step.goal if isinstance(step.goal, PoseGoal) else _absolute(step.goal, start)
        line = line_between(start, goal.base_from_moving)
        if line is None:
            findings.add(*messages.half_turn(step.origin))
            return None, None
        if line.is_point:
            return JointPath(stands, stands), stands
        path = along(self.robot.chain, self.robot.limits, tool, line, stands)
        if not isinstance(path, Broken):
            return path, path.end
        end = self._solve(goal, stands, step, findings)
        if end is not None:  # the goal can be reached, but not along the line
            findings.add(*messages.broken_line(self.robot, path, line.poses, step.origin))
        return None, end

    def _spline(
        self, step: SplineMove, stands: Array, findings: Collector
    ) -> tuple[Path | None, Array | None, Array | None]:
        """The path of a spline, where it ends, and the joint way-points that were chosen."""
        waypoints: list[Array] = []
        near = stands
        for number, goal in enumerate(step.waypoints, 1):
            q = (
                goal.q
                if isinstance(goal, JointGoal)
                else self._solve(goal, near, step, findings, f"way-point {number}: ")
            )
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

    def _curve(self, step: Motion, path: Path, findings: Collector) -> Curve | None:
        """The path in the time that the command asks for."""
        if isinstance(path, JointPath) and np.array_equal(path.start, path.end):
            findings.add(*messages.no_motion(step.origin))
        timing, tolerance = step.timing, self.settings.tolerance
        if step.tolerance is not None:
            tolerance = Tolerance(step.tolerance, tolerance.angle)
        fitted = fit(
            path,
            load_profile(step.profile),
            timing.duration,
            self.bounds.reduced(timing.share, timing.ramp),
            self.settings.grid,
            tolerance,
        )
        if isinstance(fitted, TooFast):
            findings.add(*messages.too_fast(self.robot, fitted, self.settings.grid, step))
            return None
        if isinstance(fitted, TooLong):
            findings.add(*messages.too_long(fitted, step.origin))
            return None
        if isinstance(fitted, NotHeld):
            findings.add(*messages.not_held(fitted, self.settings.grid.smallest, step.origin))
            return None
        return fitted


def _absolute(delta: PoseDelta, start: Array) -> PoseGoal:
    """The pose (4, 4) to which an increment leads from `start` (4, 4), both of the moving frame in {B}."""
    axes = delta.axes
    if delta.axes_on_flange:
        axes = start[:3, :3] @ delta.flange_from_moving[:3, :3].T @ delta.axes
    pose = np.eye(4)
    pose[:3, 3] = start[:3, 3] + axes @ delta.shift
    pose[:3, :3] = axes @ delta.turn @ axes.T @ start[:3, :3]
    return PoseGoal(pose, delta.flange_from_moving)
