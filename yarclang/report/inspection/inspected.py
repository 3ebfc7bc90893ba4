"""Collect complete information about one command of a program: frames, target, joints, inverse kinematics
solutions, time, proofs, and its lines in the controller text.
"""

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
from yarclang.report.inspection.convex import Divided, divided_bodies
from yarclang.report.inspection.flow import NO_FLOWS, Flows, flows_of
from yarclang.report.inspection.limits import Pace, pace_of
from yarclang.report.inspection.way import Way, stands_before, trouble_behind, way_to
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.nearest import Unreachable, nearest_solutions
from yarclang.robot.model import Robot


@frozen(eq=False)
class Studied:
    """A checked program: its findings, and the results of the compiler's stages that the program reached. A
    program is planned and certified only if it has no errors.
    """

    program: Program
    request: Request
    compiled: Compiled | None
    findings: tuple[Diagnostic, ...]


@frozen(eq=False)
class WayPoint:
    """A pose to which a motion goes, and the joint positions that reach it.

    Attributes:
        pose: (4, 4) base_from_moving.
        flange_from_moving: (4, 4) pose of the moving frame.
        reference: (n,) joint position; the solution nearest to it is chosen [rad or m].
        near: True if NEAR gives the reference.
        solutions: joint positions that reach the pose.
        unreachable: reason why there are no solutions; None if there are any.
    """

    pose: Array
    flange_from_moving: Array
    reference: Array
    near: bool
    solutions: tuple[Solution, ...]
    unreachable: Unreachable | None


@frozen(eq=False)
class Inspected:
    """Everything that is known about one command of a program.

    Attributes:
        robot: robot of the program.
        step: the command's step.
        number: number of this step in the program.
        start: (n,) joint positions before the command [rad or m]; None if unknown because of errors.
        end: (n,) joint positions after the command [rad or m]; None if unknown because of errors.
        motion: the planned motion; None for a command without motion, or one that can't be planned.
        begins: latest time in the program at which the command begins [s]. For each WHEN before it, the
            longer branch counts. None if unknown.
        total: duration of the program; None if unknown.
        waypoints: the poses to which the motion goes.
        pace: what limits the motion's duration.
        certificate: what is proved about the command.
        stretches: groups of the command's lines in the controller text.
        text: lines of the controller text; empty if the program has errors.
        findings: findings about this command.
        flows: the motion's corners that are passed without a stop.
        carries: parts that grippers hold during a motion.
        deeds: what a SET does to parts: verbs with the names of the parts.
        divided: bodies in convex pieces; empty for a command without motion.
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
    divided: tuple[Divided, ...] = ()

    @property
    def origin(self) -> Origin:
        """Source of the command."""
        assert not isinstance(self.step, Gap)
        return self.step.origin


def study(checked: Checked) -> Studied | None:
    """Collect the results of a check that includes planning; None if the program's robot is unknown."""
    if checked.program is None or checked.opened is None:
        return None
    return Studied(checked.program, checked.opened.request, checked.compiled, checked.diagnostics)


def inspect_step(studied: Studied, number: int) -> Inspected:
    """Inspect step `number` of a program. It must not be a Gap."""
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
        findings=_own_findings(studied, step),
        flows=flows,
        carries=() if certificate is None else certificate.carries,
        deeds=() if carried is None else carried.deeds(number),
        divided=divided_bodies(request.robot, program.cell) if isinstance(step, Motion) else (),
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


def _own_findings(studied: Studied, step: Step) -> tuple[Diagnostic, ...]:
    """Return the findings about this command."""
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
    """Return the poses to which a motion goes, with the joint positions that reach them. For a Cartesian
    motion, this is only its last pose.
    """
    step = studied.program.steps[number]
    robot = studied.request.robot
    assert isinstance(step, Motion)
    in_joints, goals = not step.leads_frame, step.goals
    waypoints: list[WayPoint] = []
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
                waypoints.append(
                    _waypoint(
                        studied, number, pose, goal.flange_from_moving, near, stands, chosen, in_joints, last
                    )
                )
        stands = goal.q if isinstance(goal, JointGoal) else chosen if chosen is not None else stands
    return tuple(waypoints)


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
    labels: dict[bytes, str] = {}

    def follow(q: Array) -> str:
        if not (last and in_joints):
            return ""
        key = q.tobytes()
        if key not in labels:
            labels[key] = trouble_behind(studied.program, number, q, studied.request)
        return labels[key]

    solutions = solutions_of(robot, flange, reference, chosen, follow, along_path=not in_joints)
    unreachable = None
    if not any(one.verdict != "out of limits" for one in solutions):
        solved = nearest_solutions(robot.chain, robot.limits, flange, reference)
        unreachable = solved if isinstance(solved, Unreachable) else None
    return WayPoint(pose, flange_from_moving, reference, near is not None, solutions, unreachable)


def chain_of(link: FrameLink | None) -> tuple[FrameLink, ...]:
    """Return a frame and its parents, up to {B} or {FLANGE}."""
    chain: list[FrameLink] = []
    while link is not None:
        chain.append(link)
        link = link.parent
    return tuple(chain)


def chain_pose(link: FrameLink) -> Array:
    """Return the pose of a frame in {B} or on {FLANGE} (4, 4)."""
    pose = np.eye(4)
    for one in chain_of(link):
        pose = one.parent_from_frame @ pose
    return pose
