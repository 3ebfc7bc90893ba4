"""Find the place at which a path of the moving frame is nearest to a singularity, and its effect on the
speed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.robot.kinematics.singularity import are_all_above, smallest_singular_values

NEAR = 0.06
"""Smallest singular value of the Jacobian below which a path counts as near a singularity. Far from
singularities, it is 0.1 to 0.5.
"""

_COSTS = 2.0
"""Ratio of the largest load near the singularity to the average load along the path, from which on the path
counts as slowed by the singularity. The load is the joints' use of their velocity limits.
"""

_STILL = 1e-9


@frozen
class Nearest:
    """The place `s` of a path that is nearest to a singularity.

    `smallest` is the smallest singular value of the Jacobian there. `joint` is the joint that moves fastest,
    relative to its velocity limit: by `rate` [rad or m per m of the path, or per rad of a pure rotation].
    `turns` is True for a pure rotation.
    """

    s: float
    smallest: float
    joint: int
    rate: float
    turns: bool


def keep_away(paths: Sequence[CartesianPath]) -> list[bool]:
    """Return, for each path, True if it is proved to keep away from singularities.

    All paths are of one arm and one moving frame.
    """
    chain, tool = paths[0].chain, paths[0].flange_from_moving
    q = [path.followed.q for path in paths]
    if are_all_above(chain, np.concatenate(q), tool, NEAR):
        return [True] * len(paths)
    return [are_all_above(chain, one, tool, NEAR) for one in q]


def nearest_singularity(path: CartesianPath, velocity: Array) -> Nearest | None:
    """Return the place at which a singularity slows a path. The result is None if the path keeps away from
    singularities, or passes them without loss of speed.

    Only places at which inverse kinematics was solved are examined; they are closer together near a
    singularity.

    Args:
        path: the path.
        velocity: the joints' velocity limits (n,) [rad/s or m/s].
    """
    extent, turns = path.extent
    s, q = path.followed.s, path.followed.q
    if extent < _STILL or are_all_above(path.chain, q, path.flange_from_moving, NEAR):
        return None
    smallest = smallest_singular_values(path.chain, q, path.flange_from_moving)
    if smallest.min() >= NEAR:
        return None
    # Joint motion per share of the path, between neighbouring places.
    slope = np.abs(np.diff(q, axis=0)) / np.diff(s)[:, None]
    # Assume that the path takes 1 s, and compute the share of its velocity limit that each joint needs. The
    # largest share is the load.
    shares = slope / velocity
    load = shares.max(axis=1)
    near = np.minimum(smallest[1:], smallest[:-1]) < NEAR
    here = int(np.argmax(np.where(near, load, 0.0)))
    if load[here] < _COSTS * float(load @ np.diff(s)):
        return None
    joint = int(np.argmax(shares[here]))
    at = here if smallest[here] < smallest[here + 1] else here + 1
    return Nearest(float(s[at]), float(smallest[at]), joint, float(slope[here, joint] / extent), turns)
