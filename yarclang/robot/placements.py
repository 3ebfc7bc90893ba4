"""Compute the placements of all bodies that a chain moves, by a product of exponentials on whole arrays. The
planner uses them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def placements(screws: Array, q: Array) -> Array:
    """Compute the placements (rotation and translation) by which the joints move the links from their places
    with all joints at zero.

    Args:
        screws: (n, 6) of a chain, linear part then angular part.
        q: (P, n) [rad or m].

    Returns:
        (n + 1, 3, 4, P): entry k is the motion of a body that the first k joints move, from its place with
            all joints at zero to its place at `q`. The first three columns are the rotation, the fourth is
            the translation [m].
    """
    count, size = q.shape
    # positions are the last index during the computation: all steps run along whole rows
    pose = np.zeros((size + 1, 3, 4, count))
    pose[0, [0, 1, 2], [0, 1, 2]] = 1.0
    way = np.ascontiguousarray(q.T)
    sin, versine = np.sin(way), 1.0 - np.cos(way)
    for joint in range(size):
        linear, angular = screws[joint, :3], screws[joint, 3:]
        w = _skew(angular)
        turn, shift = pose[joint, :, :3], pose[joint, :, 3]
        # exp(screw q), followed by the joints before: the translation is I q + (1 - cos q) w + (q - sin q) w²
        local = np.matmul(np.stack([linear, w @ linear, w @ w @ linear]), turn)
        np.multiply(local[:, 0], way[joint], out=pose[joint + 1, :, 3])
        pose[joint + 1, :, 3] += local[:, 1] * versine[joint]
        pose[joint + 1, :, 3] += local[:, 2] * (way[joint] - sin[joint])
        pose[joint + 1, :, 3] += shift
        turned = np.matmul(np.hstack([w, w @ w]).T, turn)
        np.multiply(turned[:, :3], sin[joint], out=pose[joint + 1, :, :3])
        turned[:, 3:] *= versine[joint]
        pose[joint + 1, :, :3] += turned[:, 3:]
        pose[joint + 1, :, :3] += turn
    return pose


def _skew(vector: Array) -> Array:
    """Return the cross product matrix (3, 3) of a vector (3,)."""
    x, y, z = vector.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
