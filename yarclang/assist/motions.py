"""What a motion command comes to: where it ends, how long it takes, and what it comes near to."""

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
"""Places of a motion at which its nearness to a singularity is looked at."""


@dataclass(frozen=True, slots=True, eq=False)
class MotionFacts:
    """One motion of a program.

    Attributes:
        label: its place; `number` is its step.
        frame: the frame that moves, and `base` that in which its values are given (both without braces).
        in_base: (4, 4) the moving frame in `base` at the end, None where that is the robot's own; `in_world` in {B}.
        joints: (n,) the joint positions at the end [rad or m]; None where errors hide them.
        begins: when it begins [s]; `duration` how long it takes. None where it isn't planned.
        smallest: the smallest singular value on the way; None likewise.
        certificate: what was proved; None where nothing was.
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
        """The limit that is used most, of those that slow a motion down, and what it is called."""
        return None if self.certificate is None else most_used(self.certificate)

    @property
    def clearance(self) -> Clearance | None:
        """How near the motion comes to anything."""
        one = self.certificate
        found = [each for each in (one.clearance, one.own_clearance) if each is not None] if one else []
        return min(found, key=lambda each: each.distance, default=None)


def most_used(certificate: CommandCertificate) -> tuple[str, Load]:
    """The limit of velocity, acceleration, jerk or motor speed that a motion uses most."""
    loads = [
        ("velocity", certificate.velocity),
        ("acceleration", certificate.acceleration),
        ("motor speed", certificate.motor_velocity),
    ]
    if certificate.jerk_judged:
        loads.append(("jerk", certificate.jerk))
    return max(loads, key=lambda one: one[1].share)


def facts_of(view: View, number: int) -> MotionFacts | None:
    """What is known of step `number` of a view's program; None where it is no motion, or nothing is known of the robot."""
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
    """The frame that a command moves, and where it sits on the flange; of joint motions that of DEFAULT, else of the robot."""
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
    """Where the moving frame stands in {B} at the end (4, 4)."""
    if isinstance(goal := step.end, PoseGoal):
        return goal.base_from_moving
    if joints is None:
        return None
    pose: Array = tool_poses(robot.chain, joints[None], flange_from_frame)[0]
    return pose


def pace_in(view: View, number: int) -> Pace | None:
    """What limits the time of a motion, and the shortest that works, as `yarc inspect` tells it: it plans the motion again."""
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
    """The first of some steps that is a motion."""
    return next((number for number in numbers if isinstance(view.step(number), Motion)), None)
