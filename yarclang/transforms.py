"""Compute rotations from roll pitch yaw and from quaternions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

QUATERNION_TOLERANCE = 1e-3
"""Largest allowed difference of a given quaternion's norm from 1."""


def rpy_rotation(rpy: Array) -> Array:
    """Return the rotation Rz(yaw) Ry(pitch) Rx(roll) (3, 3) for `rpy` (3,), roll pitch yaw [rad]."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy).tolist(), np.cos(rpy).tolist()
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


_STRAIGHT = 1e-9
"""If the cosine of the pitch is smaller than this, roll and yaw rotate about the same axis (gimbal lock). Yaw
is set to 0 then.
"""


def pose_matrix(values: Sequence[float]) -> Array:
    """Return the transform (4, 4) of x, y, z [m] and roll, pitch, yaw [rad]."""
    pose = np.eye(4)
    pose[:3, 3], pose[:3, :3] = values[:3], rpy_rotation(np.array(values[3:], dtype=np.float64))
    return pose


def roll_pitch_yaw(rotation: Array) -> Array:
    """Return roll pitch yaw (3,) [rad] of a rotation (3, 3). This is the inverse of `rpy_rotation`."""
    cosine = float(np.hypot(rotation[0, 0], rotation[1, 0]))
    pitch = np.arctan2(-rotation[2, 0], cosine)
    if cosine < _STRAIGHT:
        return np.array([np.arctan2(-rotation[0, 1] * np.sign(rotation[2, 0]), rotation[1, 1]), pitch, 0.0])
    return np.array(
        [
            np.arctan2(rotation[2, 1], rotation[2, 2]),
            pitch,
            np.arctan2(rotation[1, 0], rotation[0, 0]),
        ]
    )


def quaternion_rotation(quaternion: Array) -> Array:
    """Return the rotation (3, 3) of a quaternion (4,) x y z w. The quaternion is divided by its norm,
    which must not be 0.
    """
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternions(turns: Array) -> Array:
    """Return rotations (..., 3, 3) as unit quaternions x y z w (..., 4), with w not negative.

    The largest component is computed from the diagonal, and the others from this component (Shepperd, 1978).
    This is accurate for all angles.
    """
    xx, yy, zz = turns[..., 0, 0], turns[..., 1, 1], turns[..., 2, 2]
    x, y, z = (turns[..., 2, 1], turns[..., 0, 2], turns[..., 1, 0])
    u, v, w = (turns[..., 1, 2], turns[..., 2, 0], turns[..., 0, 1])
    rows = np.stack(
        [
            np.stack([1.0 + xx - yy - zz, w + z, v + y, x - u], axis=-1),
            np.stack([w + z, 1.0 - xx + yy - zz, x + u, y - v], axis=-1),
            np.stack([v + y, x + u, 1.0 - xx - yy + zz, z - w], axis=-1),
            np.stack([x - u, y - v, z - w, 1.0 + xx + yy + zz], axis=-1),
        ],
        axis=-2,
    )
    largest = np.stack([rows[..., k, k] for k in range(4)], axis=-1).argmax(axis=-1)
    found = np.take_along_axis(rows, largest[..., None, None], axis=-2)[..., 0, :]
    found = found / np.linalg.norm(found, axis=-1, keepdims=True)
    signed: Array = np.where(found[..., 3:] < 0.0, -found, found)
    return signed


def constant(values: Array) -> Array:
    """Return values as a read-only array of floats."""
    values = np.asarray(values, dtype=np.float64, order="C")
    values.setflags(write=False)
    return values


def sealed(values: Array) -> Array:
    """Return a read-only copy in row-major order."""
    return constant(np.array(values))


def turn_about(axis: int, angle: float) -> Array:
    """Return the rotation (3, 3) about axis 0, 1 or 2 by an angle [rad]."""
    turn = np.eye(3)
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn[one, one] = turn[other, other] = np.cos(angle)
    turn[other, one] = np.sin(angle)
    turn[one, other] = -turn[other, one]
    return turn
