"""Check joint limits, and compute rotations from numbers."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from yarclang.commands.spec import Values
from yarclang.diagnostics import Collector
from yarclang.hir import Array
from yarclang.robot.model import Robot
from yarclang.source import Span
from yarclang.transforms import QUATERNION_TOLERANCE, constant, quaternion_rotation, rpy_rotation


def check_limits(robot: Robot, q: Array, findings: Collector, span: Span) -> None:
    """Add a finding if a joint is outside its limits. If several joints are, the finding is about the one
    that is farthest outside.

    Args:
        robot: the robot.
        q: (n,) [rad or m].
        findings: receives the finding.
        span: place of the finding.
    """
    beyond = np.maximum(robot.limits.lower - q, q - robot.limits.upper)
    if beyond.max() <= 0.0:  # nearly always
        return
    excess = beyond / robot.axis_units
    joint = int(np.argmax(excess))
    if excess[joint] <= 1e-9:
        return
    unit = robot.axis_unit_names[joint]
    lower, upper = (
        limit[joint] / robot.axis_units[joint] for limit in (robot.limits.lower, robot.limits.upper)
    )
    others = int(np.count_nonzero(excess > 1e-9)) - 1
    more = f" ({others} other joint{'s are' if others > 1 else ' is'} out too)" if others else ""
    message = (
        f"{robot.joint_names[joint]} at {q[joint] / robot.axis_units[joint]:.6g} {unit} is outside its "
        f"limits by {excess[joint]:.4g} {unit}{more}"
    )
    help_ = f"{robot.joint_names[joint]} goes from {lower:.6g} to {upper:.6g} {unit}"
    turned = np.where(robot.chain.is_prismatic, q, np.radians(q))
    if (
        (q.round(6) != turned.round(6)).any()
        and _is_within(robot, turned)
        and np.abs(turned - q).max() > 2.0 * np.pi
    ):
        help_ = f"{help_}; are these deg and not rad? then write (deg)"
    findings.add("Y0502", message, span, help_)


def _is_within(robot: Robot, q: Array) -> bool:
    return bool(((q >= robot.limits.lower) & (q <= robot.limits.upper)).all())


def _unit_quaternion(numbers: Array, norm: float) -> str:
    """Return the help about a quaternion (4,) whose norm isn't 1."""
    order = "the order is qx qy qz qw, with the real part last"
    if not norm > QUATERNION_TOLERANCE:
        return order
    scaled = " ".join(f"{value:.9g}" for value in numbers / norm)
    return f"{order}; with the length 1 these are {scaled}"


def rotation_of(
    values: Values, numbers: Array, findings: Collector, span: Callable[[], Span]
) -> Array | None:
    """Return the rotation matrix (3, 3) for the orientation in a waypoint; None with a finding if a
    quaternion's norm isn't 1.

    Args:
        values: the kind of the waypoint's values: with a quaternion or with angles.
        numbers: (3,) roll pitch yaw [rad], or (4,) quaternion x y z w.
        findings: receives the finding.
        span: function that returns the place of the finding; called only if it is needed.
    """
    if not values.is_quaternion:
        return _rpy_rotation(numbers.tobytes())
    norm = float(np.linalg.norm(numbers))
    if abs(norm - 1.0) > QUATERNION_TOLERANCE:
        message = f"the quaternion qx qy qz qw has the norm {norm:.6g}, not 1"
        findings.add("Y0404", message, span(), _unit_quaternion(numbers, norm))
        return None
    return quaternion_rotation(numbers)


@lru_cache(maxsize=64)
def _rpy_rotation(numbers: bytes) -> Array:
    """Return the rotation matrix (3, 3) of roll pitch yaw [rad]. It is cached, since many poses often have
    the same orientation.
    """
    return constant(rpy_rotation(np.frombuffer(numbers)))
