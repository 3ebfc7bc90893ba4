"""How far two executed motions are from each other, place by place along their ways: their laws over time don't enter."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.motion.curve import Curve
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot

_SAMPLES = 2048
"""Of a motion's way over time."""

_PLACES = 513
"""Along the way, where both are compared."""


@frozen
class PathDifference:
    """The largest differences: of the tool's position [m] and orientation [rad], and of a joint, `joint` (from 0), in axis units.

    `at` is where on the way the tool's position differs most, from 0 to 1; where only the rest does, where that is.
    """

    position: float
    angle: float
    joint: int
    joint_off: float
    at: float


SAME_PATH = PathDifference(0.0, 0.0, 0, 0.0, 0.0)


def path_difference(robot: Robot, frame: str, one: Curve, other: Curve) -> PathDifference:
    """Compare two curves at equal shares of their ways in joint space.

    Args:
        robot: whose.
        frame: whose position and orientation count, one on the flange.
        one: a motion.
        other: another.
    """
    if one.points.shape == other.points.shape and np.array_equal(one.points, other.points):
        return SAME_PATH
    s = np.linspace(0.0, 1.0, _PLACES)
    q, r = _along(one, s), _along(other, s)
    tool = robot.flange_from_frame[frame]
    poses, others = tool_poses(robot.chain, q, tool), tool_poses(robot.chain, r, tool)
    off = np.linalg.norm(poses[:, :3, 3] - others[:, :3, 3], axis=1)
    # 2 sqrt(2) sin(angle / 2) is the distance of two rotations
    spread = np.linalg.norm(poses[:, :3, :3] - others[:, :3, :3], axis=(1, 2))
    angle = 2.0 * np.arcsin(np.minimum(spread / np.sqrt(8.0), 1.0))
    joints = np.abs(q - r) / robot.axis_units
    joint = int(np.argmax(joints.max(axis=0)))
    worst = int(np.argmax(off)) if off.max() > 1e-9 else int(np.argmax(joints[:, joint]))
    return PathDifference(
        float(off.max()), float(angle.max()), joint, float(joints[:, joint].max()), float(s[worst])
    )


def _along(curve: Curve, s: Array) -> Array:
    """Joint positions (N, n) [rad or m] at shares `s` (N,) of the way, counted in joint space."""
    times = np.linspace(0.0, curve.duration, _SAMPLES)
    q = curve.sample(times)[0]
    way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))))
    if way[-1] <= 0.0:
        return np.tile(q[0], (len(s), 1))
    return curve.sample(np.interp(s * way[-1], way, times))[0]
