"""Find the path of each motion of a program, from the end of the motion before it.

A pose target of a joint motion has several inverse-kinematics solutions. The choice decides which Cartesian
motions are possible after it. The nearest solution is tried first. If a later motion can't be executed after
it, the further solutions are tried.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector, Diagnostic
from yarclang.findings import CATALOGUE
from yarclang.frozen import frozen
from yarclang.handling.grasp import Grasp, Whereabouts
from yarclang.handling.walk import Handling, flange_pose, handling_of
from yarclang.hir import (
    Action,
    ArcMove,
    Array,
    AvoidMove,
    EndLoop,
    EndWhen,
    Gap,
    Goal,
    JointDelta,
    JointGoal,
    JointMove,
    LineMove,
    Loop,
    Motion,
    PoseDelta,
    PoseGoal,
    PoseSplineMove,
    SplineMove,
    Step,
    TimedMove,
)
from yarclang.identity import key_of
from yarclang.memory import NO_MEMORY, Forgetful, Memory
from yarclang.motion.chains.corners import long_chains
from yarclang.motion.leading import messages
from yarclang.motion.leading.ahead import WaysAhead
from yarclang.motion.leading.frame_motions import avoiding_line, frame_motion, frame_way
from yarclang.motion.leading.joint_motions import avoiding_motion, joint_motion, spline_motion, timed_motion
from yarclang.motion.leading.led import FrameWay, Led, LineLeg
from yarclang.motion.leading.reached import ReachedAhead
from yarclang.motion.leading.solving import Solver, flange_at, is_free
from yarclang.motion.path import Path
from yarclang.motion.recalling import told_before
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span
from yarclang.ways import Turn, Ways


@frozen(eq=False)
class Route:
    """The path of one motion, and the joint positions (k, n) [rad or m] chosen for its waypoints.

    If a line is replaced by a polyline around obstacles, `legs` are the legs of the polyline, and `path` is
    the path of the last leg.
    """

    path: Path
    waypoints: Array
    legs: tuple[LineLeg, ...] = ()


@frozen
class _Stand:
    """State of the search between two steps of the program.

    `ways` has the robot's position on the open branches of the program (None if it isn't known). `choice` is
    the index of the step whose choice of an inverse-kinematics solution led to this position; None if the
    program text determines the position. `flange` is the flange's pose base_from_flange (4, 4), if only the
    pose is known. `parts` are the places of the parts (workpieces) in the cell.
    """

    ways: Ways[Array | None]
    choice: int | None = None
    flange: Array | None = None
    parts: Whereabouts = Whereabouts()

    @property
    def q(self) -> Array | None:
        """The robot's position (n,) [rad or m]."""
        return self.ways.state


@dataclass(slots=True)
class Done:
    """The result of one step of the program.

    `before` and `behind` are the states before and after the step. `broken` is True if the step can't be
    executed from the robot's position, but perhaps from another one. `way` is the path of the moving frame,
    if the joint positions along it aren't known.
    """

    before: _Stand
    behind: _Stand
    route: Route | None = None
    found: tuple[Diagnostic, ...] = ()
    broken: bool = False
    way: FrameWay | None = None
    cell: Cell | None = None
    """The cell during the motion, with its parts where they are during the motion."""


@dataclass(slots=True)
class Router:
    """Finder of the paths for the steps of a program, from the first to the last. `done` has the results of
    the steps so far.
    """

    robot: Robot
    steps: Sequence[Step]
    start: Array
    cell: Cell | None = None
    memory: Memory = NO_MEMORY
    cells: Mapping[int, Cell | None] | None = None
    """The cell during each motion, if the caller knows it."""
    searches: int = 1
    """Number of paths around obstacles that are searched for; the fastest is used."""
    done: list[Done] = field(default_factory=list)
    _choices: dict[int, Array] = field(default_factory=dict)
    """Inverse-kinematics solutions that replace the nearest one, by the index of the step."""
    _in_vain: set[tuple[SourceFile, Span]] = field(default_factory=set)
    """Commands for which a search found no result."""
    _handling: Handling = field(init=False)
    _grasps: dict[int, Grasp] = field(default_factory=dict)
    """The effects of SET commands for grippers, by the index of the step."""
    _blocked: set[tuple[SourceFile, Span]] = field(default_factory=set)
    """Commands with blocked poses for which nearby poses were tried."""
    _ahead: WaysAhead = field(init=False)
    _reached: ReachedAhead = field(init=False)

    def __post_init__(self) -> None:
        """Prepare the tables of the whole program: targets in reach, paths ahead, and the handling of
        parts by grippers.
        """
        self._reached = ReachedAhead(self.robot, self.steps)
        self._ahead = WaysAhead(self.robot, self.steps, long_chains(self.steps))
        self._handling = handling_of(self.robot, self.cell, self.steps)

    def in_legs(self) -> tuple[tuple[Step, ...], list[Done]]:
        """Return the steps of the program and their results. A line that became a polyline around obstacles
        is replaced by one line for each leg.
        """
        steps, done = list[Step](), list[Done]()
        for step, result in zip(self.steps, self.done, strict=False):
            if not (isinstance(step, LineMove) and step.avoids) or result.route is None:
                steps.append(step)
                done.append(result)
                continue
            legs = result.route.legs
            last = replace(step, avoids=False)
            if len(legs) < 2:
                steps.append(last)
                done.append(result)
                continue
            before = result.before
            for number, leg in enumerate(legs):
                is_last = number == len(legs) - 1
                end = leg.path.end
                behind = result.behind if is_last else _moved(before, end)
                steps.append(_timed(last if is_last else _to_via(last, leg.pose), leg.share))
                found = result.found if is_last else ()
                done.append(Done(before, behind, Route(leg.path, end[None]), found, False, None, result.cell))
                before = behind
        return (*steps, *self.steps[len(self.done) :]), done

    def _solver(self, number: int, step: Motion, before: _Stand) -> Solver:
        """Return the inverse-kinematics solver for the poses of a command.

        Its searches are long only in the first pass of a loop. It measures distances out of reach only for a
        limited number of commands.
        """
        origin = step.origin
        is_again = (origin.source, origin.span) in self._in_vain
        is_known = is_again or (origin.source, origin.span) in self._blocked
        measures = not is_known and len(self._in_vain) + len(self._blocked) < MOST_MEASURED
        return Solver(self.robot, self._around(number, step, before), measures, is_again, self.searches)

    def _around(self, number: int, step: Motion, before: _Stand) -> Cell | None:
        """Return the cell as it is during a motion, with the workpieces where they are during this motion."""
        handling = self._handling
        if self.cells is not None:
            return self.cells.get(number, self.cell)
        if not handling.is_needed:
            return self.cell
        touches = handling.touches(number, self._grasps.get)
        searches = isinstance(step, LineMove) and step.avoids and isinstance(step.goal, PoseGoal)
        if (searches or not step.leads_frame) and before.q is not None:
            # Other motions of a frame are left out: only the certificate checks contacts along them.
            flange = _flange_at(self.robot, step.end, before.q)
            touches += handling.foreseen(before.parts.parts, number, flange)
        return handling.around(before.parts.parts, touches, number)

    def _first(self) -> _Stand:
        """Return the state before the first step."""
        return _Stand(Ways(self.start), parts=self._handling.first())

    def advance(self) -> None:
        """Find the path of the next step. If the step can't be executed from the robot's position, try other
        solutions for the earlier target that led to this position.
        """
        before = self.done[-1].behind if self.done else self._first()
        done = self._step(len(self.done), before)
        self.done.append(done)
        if done.broken and before.choice is not None:
            self._choose_otherwise(before.choice)

    def _choose_otherwise(self, chosen: int) -> None:
        """Try the other inverse-kinematics solutions for the target of step `chosen`, the nearest first,
        until all steps up to the latest one can be executed.
        """
        tried = self.done[chosen:]
        last = len(self.done)
        step = self.steps[chosen]
        assert isinstance(step, Motion)
        goal, near = step.end, self._near(chosen)
        if not isinstance(goal, PoseGoal) or near is None:
            return
        # Backtracking: with each solution, find the paths of all steps from `chosen` on again, until one
        # solution gets past the step that failed. If none does, restore the first result.
        for q in Solver(self.robot, self.done[chosen].cell).others(goal, near, step):
            if chosen in self._choices and np.array_equal(q, self._choices[chosen]):
                continue
            had = self._choices.get(chosen)
            self._choices[chosen] = q
            del self.done[chosen:]
            while len(self.done) < last:
                before = self.done[-1].behind if self.done else self._first()
                done = self._step(len(self.done), before)
                self.done.append(done)
                if done.broken:
                    break
            else:
                nearest = tried[0].route.waypoints[-1] if tried[0].route is not None else None
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
        """Return the joint position to which the solution for a motion's last pose should be near: the last
        waypoint before this pose, or the start.
        """
        done = self.done[number]
        if done.route is None or len(done.route.waypoints) < 2:
            return done.before.q
        return np.array(done.route.waypoints[-2])

    def _step(self, number: int, before: _Stand) -> Done:
        step = self.steps[number]
        if isinstance(step, Gap):
            return Done(before, _moved(before, None))
        findings = Collector(step.origin.source)
        findings.place = step.origin.place
        if isinstance(step, Motion):
            parts = self._handling.before_motion(before.parts, number)
            if parts is not before.parts:
                before = replace(before, parts=parts)
            solver = self._solver(number, step, before)
            if before.q is None:
                done = self._from_anywhere(solver, number, step, before, findings)
            else:
                done = self._motion(solver, number, step, before, before.q, findings)
            if not done.found:
                pass
            elif any(CATALOGUE[one.code].sort == "unreachable" for one in done.found):
                self._in_vain.add((step.origin.source, step.origin.span))
            elif any(one.code == _BLOCKED for one in done.found):
                self._blocked.add((step.origin.source, step.origin.span))
            done.cell = solver.cell
            return done
        behind = self._flow(number, step, before, findings) if isinstance(step, Action) else before
        return Done(before, behind, None, tuple(findings.found))

    def _flow(self, number: int, step: Action, stand: _Stand, findings: Collector) -> _Stand:
        """Return the state after a step that doesn't move the robot.

        The state changes only at the branches of a WHEN or a loop, and when a gripper closes or opens.
        """
        if self._handling.has_parts:
            parts, grasp = self._handling.passed(stand.parts, number, stand.q)
            if grasp is not None:
                self._grasps[number] = grasp
                if self._flows_into(number):
                    findings.add(*messages.grips_on_the_way(step.origin, grasp.closes))
            return replace(self._flowed(step, stand, findings), parts=parts)
        return self._flowed(step, stand, findings)

    def _flows_into(self, number: int) -> bool:
        """Return True if the motion before a step flows into the next motion."""
        before = next((one for one in reversed(self.steps[:number]) if isinstance(one, Motion)), None)
        return before is not None and before.blend is not None

    def _flowed(self, step: Action, stand: _Stand, findings: Collector) -> _Stand:
        if not isinstance(step, Turn):
            return stand

        def meet(one: Array | None, other: Array | None, where: Turn) -> Array | None:
            if one is None or other is None:
                return None
            if self._same(one, other):
                return other
            findings.add(*messages.ways_part(self.robot, other, one, where))
            return None

        ways = stand.ways.turned(step, meet)
        # All branches must end at one joint position. Where they meet, earlier choices of solutions are
        # therefore final.
        is_met = isinstance(step, EndWhen | Loop | EndLoop)
        return _Stand(ways, None, None, stand.parts) if is_met else replace(stand, ways=ways)

    def _same(self, one: Array, other: Array) -> bool:
        """Return True if two joint positions are equal for the controller: they differ by far less than an
        encoder count.
        """
        return bool((np.abs(one - other) <= 1e-9 * self.robot.axis_units).all())

    def _motion(
        self, solver: Solver, number: int, step: Motion, before: _Stand, q: Array, findings: Collector
    ) -> Done:
        """Find the path of one motion from the joint position `q` (n,)."""
        # A joint motion to a pose without NEAR is a new choice among solutions. Any other absolute target of
        # a joint motion determines the position.
        choice, taken = before.choice, self._choices.get(number)
        if not step.leads_frame and not isinstance(step.end, JointDelta):
            choice = number if is_free(step.end) else None
        key: Hashable = ()
        if not isinstance(self.memory, Forgetful):
            chosen = None if taken is None else taken.tobytes()
            kept = (self.robot, solver.cell, q.tobytes(), chosen, key_of(step))
            key = ("route", *kept, solver.measures, solver.is_again, solver.searches)

        def make() -> tuple[Led, Route | None]:
            is_fixed = isinstance(step, ArcMove) or (isinstance(step, LineMove) and not step.avoids)
            path = self._ahead.path(number, q) if is_fixed else None
            if path is not None:
                end = path.end
                waypoints = end[None]
                return Led(path, end, waypoints), Route(path, waypoints)
            led = self._led(solver, step, q, taken, findings)
            if led.path is None or led.waypoints is None:
                return led, None
            return led, Route(led.path, led.waypoints, led.legs)

        # The fix for a path around obstacles declares names that must not occur elsewhere in the text. The
        # finding therefore depends on other lines.
        around = isinstance(step, AvoidMove)
        led, route = told_before(self.memory, key, step.origin, findings, make, may_look_around=around)
        behind = _Stand(
            Ways(led.end, before.ways.ends, before.ways.open), choice, before.flange, before.parts
        )
        return Done(before, behind, route, tuple(findings.found), led.broken)

    @staticmethod
    def _led(solver: Solver, step: Motion, q: Array, taken: Array | None, findings: Collector) -> Led:
        match step:
            case JointMove():
                return joint_motion(solver, step, q, findings, taken)
            case AvoidMove():
                return avoiding_motion(solver, step, q, findings, taken)
            case SplineMove():
                return spline_motion(solver, step, q, findings, taken)
            case TimedMove():
                return timed_motion(solver, step, q, findings)
            case LineMove(avoids=True):
                return avoiding_line(solver, step, q, findings)
            case LineMove() | ArcMove() | PoseSplineMove():
                return frame_motion(solver, step, q, findings)

    def _from_anywhere(
        self, solver: Solver, number: int, step: Motion, before: _Stand, findings: Collector
    ) -> Done:
        """Check a motion without knowing the robot's position before it: its poses must be in reach, and the
        moving frame must have a path to its goal.
        """
        flange = None if before.flange is None else before.flange.tobytes()
        key = ("anywhere", self.robot, flange, key_of(step), solver.measures)

        def make() -> tuple[Array | None, Array | None, FrameWay | None]:
            return self._goals_from_anywhere(solver, number, step, before, findings)

        q, flange_after, way = told_before(self.memory, key, step.origin, findings, make)
        behind = replace(_moved(before, q), flange=flange_after)
        return Done(before, behind, None, tuple(findings.found), way=way)

    def _goals_from_anywhere(
        self, solver: Solver, number: int, step: Motion, before: _Stand, findings: Collector
    ) -> tuple[Array | None, Array | None, FrameWay | None]:
        """Return what is known about the end of a motion if the robot's position before it is unknown.

        Returns:
            The joint position at the end (n,), the flange's pose at the end (4, 4), and the path of the
            moving frame. Each is None if it isn't known.
        """
        if isinstance(step, TimedMove):
            return step.table.positions[-1], None, None
        goals: tuple[Goal, ...] = step.goals
        way = None
        if before.flange is not None and isinstance(step, LineMove | ArcMove | PoseSplineMove):
            way, last = frame_way(step, before.flange, findings)
            goals = (*goals[:-1], last)
        reached = [
            self._reached.is_sure(number) or solver.nearest(goal, self.robot.home, step, findings) is not None
            for goal in goals
            if isinstance(goal, PoseGoal)
        ]
        last_goal = goals[-1]
        q = last_goal.q if isinstance(last_goal, JointGoal) else None
        flange = flange_at(last_goal) if isinstance(last_goal, PoseGoal) and all(reached) else None
        return q, flange, way


_BLOCKED = "Y0925"

MOST_MEASURED = 20
"""Largest number of commands of a program for which the distance out of reach is measured. Measuring one
distance takes about 0.1 s.
"""


def _to_via(step: LineMove, pose: Array) -> LineMove:
    """Return one leg of a polyline: the line of `step` with another goal pose (4, 4), at which the robot
    stops.
    """
    return replace(step, goal=PoseGoal(pose, step.goal.flange_from_moving), blend=None, search=None)


def _timed(step: LineMove, share: float) -> LineMove:
    """Return a leg of a polyline. If the line has a given duration, the leg gets its share of it."""
    duration = step.timing.duration
    return step if duration is None else replace(step, timing=replace(step.timing, duration=share * duration))


def _moved(stand: _Stand, q: Array | None) -> _Stand:
    """Return the state after a motion to the joint position `q` (n,) [rad or m]. `q` is None if the position
    isn't known.
    """
    # Making a new state is twice as fast as `replace`. This matters, since after each edit of a program a
    # state is made for every motion.
    return _Stand(Ways(q, stand.ways.ends, stand.ways.open), None, None, stand.parts)


def _flange_at(robot: Robot, goal: Goal, stands: Array) -> Array:
    """Return the flange's pose base_from_flange (4, 4) at the goal of a joint motion from the joint position
    `stands` (n,).
    """
    match goal:
        case PoseGoal():
            return flange_at(goal)
        case JointGoal(q=q):
            return flange_pose(robot, q)
        case JointDelta(dq=dq):
            return flange_pose(robot, stands + dq)
        case PoseDelta():
            raise AssertionError("only a motion of the moving frame has increments of a pose")
