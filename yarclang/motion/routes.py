"""Where the motions of a program lead: the path of each, from where the last one ended.

A pose target of a joint motion has several solutions, and which one is taken decides what the Cartesian motions behind it can do. The
nearest is taken first; where a motion that follows can't be done from there, the next ones are tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector, Diagnostic
from yarclang.frozen import frozen
from yarclang.hir import (
    Action,
    ArcMove,
    Array,
    AvoidMove,
    Else,
    EndWhen,
    Gap,
    JointDelta,
    JointGoal,
    JointMove,
    LineMove,
    Motion,
    Origin,
    PoseGoal,
    PoseSplineMove,
    SplineMove,
    Step,
    When,
)
from yarclang.identity import key_of
from yarclang.memory import NO_MEMORY, Memory
from yarclang.motion.leading import messages
from yarclang.motion.leading.frame_motions import frame_motion, frame_way
from yarclang.motion.leading.joint_motions import avoiding_motion, joint_motion, spline_motion
from yarclang.motion.leading.led import FrameWay, Led
from yarclang.motion.leading.solving import Solver, flange_at, is_free
from yarclang.motion.path import Path
from yarclang.motion.recalling import told_before
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span


@frozen(eq=False)
class Route:
    """The path of one motion, and the joint positions (k, n) [rad or m] that were chosen for its way-points."""

    path: Path
    waypoints: Array


@frozen
class _Ways:
    """A WHEN that isn't ended: where the robot stood before it, and where its first way ends, once there is a second."""

    when: When
    before: _Stand
    first: Array | None = None
    parted: bool = False


@frozen
class _Stand:
    """What is known between two steps: where the robot stands (None: nowhere known), the WHENs around, and the last motion whose
    solution was chosen and decides where the robot stands (None: where it stands was written). `flange` is where the flange stands,
    base_from_flange (4, 4), where no more than that is known.
    """

    q: Array | None
    ways: tuple[_Ways, ...] = ()
    choice: int | None = None
    flange: Array | None = None


@dataclass(slots=True)
class _Done:
    """What came of one step. `broken` says that it can't be done from where the robot stood, though perhaps from elsewhere; `way` is
    that of its frame where no more is known of it.
    """

    before: _Stand
    behind: _Stand
    route: Route | None = None
    found: tuple[Diagnostic, ...] = ()
    broken: bool = False
    way: FrameWay | None = None


@dataclass(slots=True)
class Router:
    """Routes the steps of a program one after the other; `done` has what came of each."""

    robot: Robot
    steps: Sequence[Step]
    start: Array
    cell: Cell | None = None
    memory: Memory = NO_MEMORY
    done: list[_Done] = field(default_factory=list)
    _choices: dict[int, Array] = field(default_factory=dict)
    """What was taken instead of the nearest, by step."""
    _in_vain: set[tuple[SourceFile, Span]] = field(default_factory=set)
    """The commands for which was searched, and nothing found."""

    def _solver(self, origin: Origin) -> Solver:
        """What solves the poses of a command. It searches long only in the first round of a loop, and for how far poses are out of reach for some
        commands of a program.
        """
        is_again = (origin.source, origin.span) in self._in_vain
        measures = not is_again and len(self._in_vain) < MOST_MEASURED
        return Solver(self.robot, self.cell, measures, is_again)

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
        step = self.steps[chosen]
        assert isinstance(step, Motion)
        for q in Solver(self.robot, self.cell).others(goal, near, step):
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
        """To what the solution of the last pose of a motion shall be near."""
        done = self.done[number]
        if done.route is None or len(done.route.waypoints) < 2:
            return done.before.q
        return np.array(done.route.waypoints[-2])

    def _step(self, number: int, before: _Stand) -> _Done:
        step = self.steps[number]
        if isinstance(step, Gap):
            return _Done(before, replace(before, q=None, choice=None, flange=None))
        findings = Collector(step.origin.source)
        findings.place = step.origin.place
        if isinstance(step, Motion):
            solver = self._solver(step.origin)
            if before.q is None:
                done = self._from_anywhere(solver, step, before, findings)
            else:
                done = self._motion(solver, number, step, before, before.q, findings)
            if any(one.code in _IN_VAIN for one in done.found):
                self._in_vain.add((step.origin.source, step.origin.span))
            return done
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
                return replace(here.before, ways=(*outer, parted))
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

    def _motion(
        self, solver: Solver, number: int, step: Motion, before: _Stand, q: Array, findings: Collector
    ) -> _Done:
        """Route one motion from `q` (n,)."""
        choice, taken = before.choice, self._choices.get(number)
        if isinstance(step, SplineMove):
            choice = number if is_free(step.waypoints[-1]) else None
        elif isinstance(step, JointMove | AvoidMove) and not isinstance(step.goal, JointDelta):
            choice = number if is_free(step.goal) else None
        chosen = None if taken is None else taken.tobytes()
        key = (
            "route",
            self.robot,
            self.cell,
            q.tobytes(),
            chosen,
            key_of(step),
            solver.measures,
            solver.is_again,
        )

        def make() -> tuple[Led, Route | None]:
            led = self._led(solver, step, q, taken, findings)
            if led.path is None or led.waypoints is None:
                return led, None
            return led, Route(led.path, led.waypoints)

        # the fix of a way round takes names that stand nowhere in the text
        around = isinstance(step, AvoidMove)
        led, route = told_before(self.memory, key, step.origin, findings, make, may_look_around=around)
        behind = replace(before, q=led.end, choice=choice)
        return _Done(before, behind, route, tuple(findings.found), led.broken)

    @staticmethod
    def _led(solver: Solver, step: Motion, q: Array, taken: Array | None, findings: Collector) -> Led:
        match step:
            case JointMove():
                return joint_motion(solver, step, q, findings, taken)
            case AvoidMove():
                return avoiding_motion(solver, step, q, findings, taken)
            case SplineMove():
                return spline_motion(solver, step, q, findings, taken)
            case LineMove() | ArcMove() | PoseSplineMove():
                return frame_motion(solver, step, q, findings)

    def _from_anywhere(self, solver: Solver, step: Motion, before: _Stand, findings: Collector) -> _Done:
        """Check what can be checked of a motion from an unknown place: whether its poses can be reached at all, and the way of its frame."""
        flange = None if before.flange is None else before.flange.tobytes()
        key = ("anywhere", self.robot, flange, key_of(step), solver.measures)

        def make() -> tuple[Array | None, Array | None, FrameWay | None]:
            return self._goals_from_anywhere(solver, step, before, findings)

        q, flange_after, way = told_before(self.memory, key, step.origin, findings, make)
        behind = replace(before, q=q, choice=None, flange=flange_after)
        return _Done(before, behind, None, tuple(findings.found), way=way)

    def _goals_from_anywhere(
        self, solver: Solver, step: Motion, before: _Stand, findings: Collector
    ) -> tuple[Array | None, Array | None, FrameWay | None]:
        """Return where a motion from an unknown place leads: joint positions (n,) if they are written, the flange's pose (4, 4), and the way of its frame."""
        goals = step.waypoints if isinstance(step, SplineMove | PoseSplineMove) else (step.goal,)
        way = None
        if before.flange is not None and isinstance(step, LineMove | ArcMove | PoseSplineMove):
            way, last = frame_way(step, before.flange, findings)
            goals = (*goals[:-1], last)
        reached = [
            solver.nearest(goal, self.robot.home, step, findings) is not None
            for goal in goals
            if isinstance(goal, PoseGoal)
        ]
        last_goal = goals[-1]
        q = last_goal.q if isinstance(last_goal, JointGoal) else None
        flange = flange_at(last_goal) if isinstance(last_goal, PoseGoal) and all(reached) else None
        return q, flange, way


_IN_VAIN = ("Y0501", "Y0503", "Y0923")
"""Codes of findings after a search that found nothing."""

MOST_MEASURED = 20
"""Commands of a program for which is searched how far they are out of reach: each search takes about 0.1 s."""


def _last_goal(step: Step) -> PoseGoal | None:
    goal = step.waypoints[-1] if isinstance(step, SplineMove) else getattr(step, "goal", None)
    return goal if isinstance(goal, PoseGoal) else None
