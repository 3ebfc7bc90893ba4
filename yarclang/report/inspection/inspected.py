"""Everything that is known of one command of a program: frames, target, joints, solutions, time, proofs, and its lines for the controller."""

from __future__ import annotations

import numpy as np

from yarclang.certify.certificate import CommandCertificate
from yarclang.diagnostics import Diagnostic
from yarclang.emitted.purposes import Stretch
from yarclang.frozen import frozen
from yarclang.hir import (
    Array,
    FrameLink,
    Gap,
    JointGoal,
    Motion,
    Origin,
    PoseDelta,
    PoseGoal,
    Program,
    Step,
)
from yarclang.lasting import Lasting
from yarclang.motion.plan import PlannedMotion
from yarclang.pipeline.checking import Checked
from yarclang.pipeline.line_map import map_lines
from yarclang.pipeline.stages import Compiled, Request
from yarclang.report.carried import carried_in_plan
from yarclang.report.inspection.branches import Solution, solutions_of
from yarclang.report.inspection.flow import NO_FLOWS, Flows, flows_of
from yarclang.report.inspection.limits import Pace, pace_of
from yarclang.report.inspection.way import Way, stands_before, trouble_behind, way_to
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.nearest import Unreachable, nearest_solutions
from yarclang.robot.model import Robot


@frozen(eq=False)
class Studied:
    """A program as far as it can be understood, with all that is said of it: planned and certified only if it has no errors."""

    program: Program
    request: Request
    compiled: Compiled | None
    findings: tuple[Diagnostic, ...]


@frozen(eq=False)
class WayPoint:
    """A pose that a motion goes to: `pose` (4, 4) is base_from_moving, with the frame at `flange_from_moving`. `reference` (n,)
    [rad or m] is from where the nearest solution counts (`near`: NEAR says so).
    """

    pose: Array
    flange_from_moving: Array
    reference: Array
    near: bool
    solutions: tuple[Solution, ...]
    unreachable: Unreachable | None


@frozen(eq=False)
class Inspected:
    """A command.

    Attributes:
        robot: whose.
        step: what it is.
        number: its number in the program.
        start: (n,) the joint positions before it [rad or m]; None where errors hide them.
        end: (n,) those behind it.
        motion: as it is planned; None for what doesn't move, or can't be planned.
        begins: when it begins in the program [s], the latest known time after a WHEN; None where that isn't known.
        total: how long the program takes; None likewise.
        waypoints: the poses that it goes to.
        pace: what limits its time.
        certificate: what was proved.
        stretches: its lines in the controller's text, and `text`, the lines of that; empty where the program has errors.
        findings: what is wrong with this command.
        flows: the corners in motion that it has to do with.
        carries: the parts that grippers hold during a motion.
        deeds: what a SET does to parts, verb and names.
    """

    robot: Robot
    step: Step
    number: int
    start: Array | None
    end: Array | None
    motion: PlannedMotion | None
    begins: float | None
    total: Lasting | None
    waypoints: tuple[WayPoint, ...]
    pace: Pace | None
    certificate: CommandCertificate | None
    stretches: tuple[Stretch, ...]
    text: tuple[str, ...]
    findings: tuple[Diagnostic, ...]
    flows: Flows = NO_FLOWS
    carries: tuple[str, ...] = ()
    deeds: tuple[tuple[str, tuple[str, ...]], ...] = ()

    @property
    def origin(self) -> Origin:
        """Where it comes from."""
        assert not isinstance(self.step, Gap)
        return self.step.origin


def study(checked: Checked) -> Studied | None:
    """A program that was checked with planning; None where it isn't known for which robot it is."""
    if checked.program is None or checked.opened is None:
        return None
    return Studied(checked.program, checked.opened.request, checked.compiled, checked.diagnostics)


def inspect_step(studied: Studied, number: int) -> Inspected:
    """Look at step `number` of a program, which isn't a Gap."""
    program, request, compiled = studied.program, studied.request, studied.compiled
    step = program.steps[number]
    assert not isinstance(step, Gap)
    way = _way(studied, number)
    motion = way.motion
    begins: float | None = None
    total: Lasting | None = None
    certificate: CommandCertificate | None = None
    stretches: tuple[Stretch, ...] = ()
    text: tuple[str, ...] = ()
    if compiled is not None:
        total = compiled.plan.lasting
        begins = compiled.plan.schedule.clocks[number]
        certificate = next((one for one in compiled.certificate.commands if one.step == number), None)
        stretches = map_lines(compiled.text).of(number)
        text = tuple(compiled.text.splitlines())
    end = way.start if not isinstance(step, Motion) else None
    if motion is not None:
        end = motion.waypoints[-1]
    elif isinstance(step, Motion) and isinstance(step.end, JointGoal):
        end = step.end.q
    carried = carried_in_plan(compiled.plan) if compiled is not None else None
    pace, flows = None, NO_FLOWS if compiled is None else flows_of(compiled.plan, number)
    if motion is not None and way.start is not None and isinstance(step, Motion):
        is_part = flows.before is not None or flows.behind is not None
        pace = pace_of(program, step, way.start, motion, request, flows=is_part)
    return Inspected(
        robot=request.robot,
        step=step,
        number=number,
        start=way.start,
        end=end,
        motion=motion,
        begins=begins,
        total=total,
        waypoints=_waypoints(studied, number, way) if isinstance(step, Motion) else (),
        pace=pace,
        certificate=certificate,
        stretches=stretches,
        text=text,
        findings=_own(studied, step),
        flows=flows,
        carries=() if certificate is None else certificate.carries,
        deeds=() if carried is None else carried.deeds(number),
    )


def _way(studied: Studied, number: int) -> Way:
    program, step = studied.program, studied.program.steps[number]
    if studied.compiled is not None:
        for motion in studied.compiled.plan.motions:
            if motion.step == number:
                return Way(motion.path.start, motion)
    if not isinstance(step, Motion):
        return Way(stands_before(program, number, studied.request), None)
    return way_to(program, number, studied.request)


def _own(studied: Studied, step: Step) -> tuple[Diagnostic, ...]:
    """The findings about this command."""
    assert not isinstance(step, Gap)
    origin = step.origin
    return tuple(
        one
        for one in studied.findings
        for source, span in (one.made_at,)
        if source is origin.source
        and span is not None
        and span.line == origin.span.line
        and one.place in ("", origin.place)
    )


def _waypoints(studied: Studied, number: int, way: Way) -> tuple[WayPoint, ...]:
    """The poses of a motion, each with its solutions; of a Cartesian motion the last one."""
    step = studied.program.steps[number]
    robot = studied.request.robot
    assert isinstance(step, Motion)
    in_joints, goals = not step.leads_frame, step.goals
    found: list[WayPoint] = []
    stands = way.start
    chosen_ones = way.motion.waypoints if way.motion is not None else None
    for place, goal in enumerate(goals):
        last = place == len(goals) - 1
        chosen = None
        if chosen_ones is not None and (len(chosen_ones) == len(goals) or last):
            chosen = chosen_ones[place if len(chosen_ones) == len(goals) else -1]
        if isinstance(goal, PoseGoal | PoseDelta) and (in_joints or last):
            pose = goal.base_from_moving if isinstance(goal, PoseGoal) else None
            if pose is None and chosen is not None:
                pose = tool_poses(robot.chain, chosen[None], goal.flange_from_moving)[0]
            if pose is not None:
                near = goal.near if isinstance(goal, PoseGoal) else None
                found.append(
                    _waypoint(
                        studied, number, pose, goal.flange_from_moving, near, stands, chosen, in_joints, last
                    )
                )
        stands = goal.q if isinstance(goal, JointGoal) else chosen if chosen is not None else stands
    return tuple(found)


def _waypoint(
    studied: Studied,
    number: int,
    pose: Array,
    flange_from_moving: Array,
    near: Array | None,
    stands: Array | None,
    chosen: Array | None,
    in_joints: bool,
    last: bool,
) -> WayPoint:
    robot = studied.request.robot
    reference = near if near is not None else stands if stands is not None else robot.home
    flange = pose @ np.linalg.inv(flange_from_moving)
    known: dict[bytes, str] = {}

    def follow(q: Array) -> str:
        if not (last and in_joints):
            return ""
        key = q.tobytes()
        if key not in known:
            known[key] = trouble_behind(studied.program, number, q, studied.request)
        return known[key]

    solutions = solutions_of(robot, flange, reference, chosen, follow, along_path=not in_joints)
    unreachable = None
    if not any(one.verdict != "out of limits" for one in solutions):
        solved = nearest_solutions(robot.chain, robot.limits, flange, reference)
        unreachable = solved if isinstance(solved, Unreachable) else None
    return WayPoint(pose, flange_from_moving, reference, near is not None, solutions, unreachable)


def chain_of(link: FrameLink | None) -> tuple[FrameLink, ...]:
    """A frame and those that it hangs on, up to {B} or {FLANGE}."""
    chain: list[FrameLink] = []
    while link is not None:
        chain.append(link)
        link = link.parent
    return tuple(chain)


def chain_pose(link: FrameLink) -> Array:
    """Where a frame sits in {B} or on {FLANGE}: (4, 4)."""
    pose = np.eye(4)
    for one in chain_of(link):
        pose = one.parent_from_frame @ pose
    return pose
