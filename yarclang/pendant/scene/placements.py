"""Placements of a robot's links as positions and quaternions, so that pages need no kinematics."""

from __future__ import annotations

import numpy as np

from yarclang.robot.kinematics.fk import joint_transform
from yarclang.robot.model import Array, Chain


def moved_links(chain: Chain, q: Array) -> Array:
    """Compute the displacement of the links by the joints.

    Args:
        chain: n joints.
        q: (N, n) [rad or m].

    Returns:
        (N, n, 4, 4): transforms from a link's pose with all joints at zero to its pose. Row k is for links
        moved
            by the first k + 1 joints.
    """
    count = len(q)
    moved = np.empty((count, chain.size, 4, 4))
    before = np.broadcast_to(np.eye(4), (count, 4, 4))
    for joint in range(chain.size):
        step = np.zeros((count, 4, 4))
        step[:, :3, :3], step[:, :3, 3] = joint_transform(chain.screws[joint], q[:, joint])
        step[:, 3, 3] = 1.0
        moved[:, joint] = before = before @ step
    return moved


def packed(moved: Array) -> Array:
    """Return transforms (..., 4, 4) as x y z [m] and the unit quaternion x y z w (..., 7)."""
    return np.concatenate([moved[..., :3, 3], quaternions(moved[..., :3, :3])], axis=-1)


def quaternions(turns: Array) -> Array:
    """Return rotations (..., 3, 3) as unit quaternions x y z w (..., 4), w not negative.

    The largest component is computed from the diagonal, the others from it (Shepperd, 1978): this is exact
    for turns by any angle.
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
