"""Displacements of a robot's links for given joint positions, as positions and quaternions. With them, pages
can draw the robot without computing kinematics.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.kinematics.fk import joint_transform
from yarclang.robot.model import Array, Chain
from yarclang.transforms import quaternions


def moved_links(chain: Chain, q: Array) -> Array:
    """Compute the displacements of a robot's links from their poses with all joints at zero.

    Args:
        chain: kinematic chain with n joints.
        q: (N, n) joint positions [rad or m].

    Returns:
        Transforms (N, n, 4, 4) in {B} that move each link from its pose with all joints at zero to its pose
        at q. Matrix k is that of the link that joint k carries.
    """
    count = len(q)
    moved = np.empty((count, chain.size, 4, 4))
    before = np.broadcast_to(np.eye(4), (count, 4, 4))
    # Product of exponentials: a link is displaced by the product of the screw motions of all joints before
    # it.
    for joint in range(chain.size):
        step = np.zeros((count, 4, 4))
        step[:, :3, :3], step[:, :3, 3] = joint_transform(chain.screws[joint], q[:, joint])
        step[:, 3, 3] = 1.0
        moved[:, joint] = before = before @ step
    return moved


def packed(moved: Array) -> Array:
    """Convert transforms (..., 4, 4) to positions x y z [m] and unit quaternions x y z w, as (..., 7)."""
    return np.concatenate([moved[..., :3, 3], quaternions(moved[..., :3, :3])], axis=-1)
