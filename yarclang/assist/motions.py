"""Facts about motion commands: target, duration, and distances from obstacles and singularities."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from yarclang.assist.view import View
from yarclang.certify.certificate import Clearance, CommandCertificate, Load
from yarclang.hir import Array, FrameLink, JointGoal, Motion, PoseGoal
from yarclang.report.inspection.inspected import chain_of, chain_pose
from yarclang.report.inspection.limits import Pace, pace_of
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.singularity import smallest_singular_values
from yarclang.robot.model import Robot

_SAMPLES = 201
"""Number of samples of a motion at which its distance from singularities is computed."""


@dataclass(frozen=True, slots=True, eq=False)
class MotionFacts:
    """Facts about one motion of a program, for hover texts.

    Attributes:
        label: label of the command.
        number: number of the motion's step.
        frame: the moving frame, without braces.
        base: frame of the programmed values, without braces.
        in_base: (4, 4) moving frame in `base` at the end; None if `base` is the robot's base.
        in_world: (4, 4) moving frame in {B} at the end.
        joints: (n,) joint positions at the end [rad or m]; None if they are unknown because of errors.
        begins: time at which the motion begins [s]; None if the motion isn't planned.
        duration: duration [s]; None if the motion isn't planned.
        smallest: smallest singular value of the Jacobian during the motion; None if the motion isn't planned.
        certificate: proved properties; None if nothing was proved.
    """

    label: str
    number: int
    frame: str
    base: str
    in_base: Array | None
    in_world: Array | None
    joints: Array | None
    begins: float | None = None
    duration: float | None = None
    smallest: float | None = None
    certificate: CommandCertificate | None = None

    @property
    def load(self) -> tuple[str, Load] | None:
        """Return the limit that the motion uses most, with its name."""
        return None if self.certificate is None else most_used(self.certificate)

    @property
    def clearance(self) -> Clearance | None:
        """Return the smallest clearance of the motion."""
        one = self.certificate
        found = [each for each in (one.clearance, one.own_clearance) if each is not None] if one else []
        return min(found, key=lambda each: each.distance, default=None)


def most_used(certificate: CommandCertificate) -> tuple[str, Load]:
    """Return the limit of velocity, acceleration, jerk or motor speed that a motion uses most, with its
    name.
    """
    loads = [
        ("velocity", certificate.velocity),
        ("acceleration", certificate.acceleration),
        ("motor speed", certificate.motor_velocity),
    ]
    if certificate.jerk_judged:
        loads.append(("jerk", certificate.jerk))
    return max(loads, key=lambda one: one[1].share)


def facts_of(view: View, number: int) -> MotionFacts | None:
    """Return the facts about a step; None if the step is no motion, or the robot isn't known."""
    step, robot = view.step(number), view.robot
    if not isinstance(step, Motion) or robot is None:
        return None
    planned = view.motion(number)
    joints: Array | None = None
    if planned is not None:
        joints = planned[0].waypoints[-1]
    elif isinstance(step.end, JointGoal):
        joints = step.end.q
    frame, flange_from_frame = _moving(view, step.origin.moving, robot)
    world = _world(step, joints, flange_from_frame, robot)
    base = step.origin.base
    in_base = None
    if world is not None and base is not None and base.parent is not None and chain_of(base)[-1].name == "B":
        in_base = np.linalg.inv(chain_pose(base)) @ world
    facts = MotionFacts(step.origin.label, number, frame, base.name if base else "B", in_base, world, joints)
    if planned is None:
        return facts
    motion, begins = planned
    curve = motion.curve
    q = curve.sample(np.linspace(0.0, curve.duration, _SAMPLES))[0]
    smallest = float(smallest_singular_values(robot.chain, q, flange_from_frame).min())
    return replace(
        facts, begins=begins, duration=curve.duration, smallest=smallest, certificate=view.proved(number)
    )


def _moving(view: View, link: FrameLink | None, robot: Robot) -> tuple[str, Array]:
    """Return the name of the frame that a command moves, and its pose flange_from_frame (4, 4).

    Without `link`, as for joint motions, this is the moving frame of DEFAULT, or else {TCP}, or {FLANGE} if
    the robot has no {TCP}.
    """
    if link is not None:
        return link.name, chain_pose(link)
    default = view.sketch.default
    if default is not None and default.moving is not None and view.scope is not None:
        frame = view.scope.frame(default.moving.name)
        if frame is not None and frame.on_flange:
            return default.moving.name, frame.transform
    name = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
    return name, robot.flange_from_frame.get(name, np.eye(4))


def _world(step: Motion, joints: Array | None, flange_from_frame: Array, robot: Robot) -> Array | None:
    """Return the pose base_from_frame (4, 4) of the moving frame at the end of a motion.

    Args:
        step: the motion.
        joints: (n,) joint positions at the end of the motion [rad or m]; None if they aren't known.
        flange_from_frame: (4, 4) pose of the moving frame on the flange.
        robot: the robot.
    """
    if isinstance(goal := step.end, PoseGoal):
        return goal.base_from_moving
    if joints is None:
        return None
    pose: Array = tool_poses(robot.chain, joints[None], flange_from_frame)[0]
    return pose


def pace_in(view: View, number: int) -> Pace | None:
    """Return the shortest possible time of a motion, and the limit that determines it.

    The values are equal to those of `yarc inspect`. The motion is planned again.
    """
    step, planned = view.step(number), view.motion(number)
    checked = view.checked
    if checked is None or checked.opened is None or planned is None or not isinstance(step, Motion):
        return None
    assert view.program is not None
    request = checked.opened.request
    return pace_of(
        view.program, step, planned[0].path.start, planned[0], request, flows=number in view.flowing
    )


def first_motion(view: View, numbers: Iterable[int]) -> int | None:
    """Return the first step that is a motion."""
    return next((number for number in numbers if isinstance(view.step(number), Motion)), None)
