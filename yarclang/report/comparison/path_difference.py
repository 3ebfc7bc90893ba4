"""Compute the difference of two executed motions at equal places along their paths, regardless of timing."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.motion.curve import Curve
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot

_SAMPLES = 2048
"""Number of samples of a motion over time."""

_PLACES = 513
"""Number of places along the path at which the motions are compared."""


@frozen
class PathDifference:
    """The largest differences between the paths of two motions.

    Attributes:
        position: difference of the tool's position [m].
        angle: difference of the tool's orientation [rad].
        joint: the joint with the largest difference, from 0.
        joint_off: difference of this joint, in axis units.
        at: place on the path, from 0 to 1, with the largest difference in position. If the tool's positions
            are equal everywhere, it is the place with the largest difference of the joint `joint`.
    """

    position: float
    angle: float
    joint: int
    joint_off: float
    at: float


SAME_PATH = PathDifference(0.0, 0.0, 0, 0.0, 0.0)


def path_difference(robot: Robot, frame: str, curve: Curve, other: Curve) -> PathDifference:
    """Compare two motions at places where both have covered the same share of their length in joint space.

    Args:
        robot: robot of both motions.
        frame: frame on the flange whose position and orientation are compared.
        curve: a motion.
        other: another motion.
    """
    if curve.points.shape == other.points.shape and np.array_equal(curve.points, other.points):
        return SAME_PATH
    s = np.linspace(0.0, 1.0, _PLACES)
    q, r = _along(curve, s), _along(other, s)
    tool = robot.flange_from_frame[frame]
    poses, others = tool_poses(robot.chain, q, tool), tool_poses(robot.chain, r, tool)
    off = np.linalg.norm(poses[:, :3, 3] - others[:, :3, 3], axis=1)
    # The Frobenius distance of two rotations that differ by an angle is 2 sqrt(2) sin(angle / 2).
    spread = np.linalg.norm(poses[:, :3, :3] - others[:, :3, :3], axis=(1, 2))
    angle = 2.0 * np.arcsin(np.minimum(spread / np.sqrt(8.0), 1.0))
    joints = np.abs(q - r) / robot.axis_units
    joint = int(np.argmax(joints.max(axis=0)))
    worst = int(np.argmax(off)) if off.max() > 1e-9 else int(np.argmax(joints[:, joint]))
    return PathDifference(
        float(off.max()), float(angle.max()), joint, float(joints[:, joint].max()), float(s[worst])
    )


def _along(curve: Curve, s: Array) -> Array:
    """Return joint positions (N, n) [rad or m] at shares `s` (N,) of the curve's length in joint space."""
    times = np.linspace(0.0, curve.duration, _SAMPLES)
    q = curve.sample(times)[0]
    way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))))
    if way[-1] <= 0.0:
        return np.tile(q[0], (len(s), 1))
    return curve.sample(np.interp(s * way[-1], way, times))[0]
