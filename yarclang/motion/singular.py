"""Measure how near a path of the moving frame comes to a singularity, and the effect on speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.robot.kinematics.singularity import are_all_above, smallest_singular_values

NEAR = 0.06
"""Smallest singular value below which a path counts as near a singularity; far from one it is 0.1 to 0.5."""

_COSTS = 2.0
"""Ratio of the joints' load near a singularity to the average load, from which the path counts as slowed by
the singularity.
"""

_STILL = 1e-9


@frozen
class Nearest:
    """The place `s` of a path that is nearest to a singularity.

    `smallest` is the smallest singular value of the Jacobian there. `joint` is the joint that moves most, by
    `rate` [rad or m per m of the path, or per rad of a pure turn]. `turns` is True for a pure turn.
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
    """Return the place where a singularity slows a path; None if the path keeps away from singularities, or
    passes them without loss of speed.

    The places examined are those at which inverse kinematics was solved; they are denser near a singularity.

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
    slope = np.abs(np.diff(q, axis=0)) / np.diff(s)[:, None]
    # The share of its speed limit that the busiest joint needs if the path takes 1 s.
    shares = slope / velocity
    load = shares.max(axis=1)
    near = np.minimum(smallest[1:], smallest[:-1]) < NEAR
    here = int(np.argmax(np.where(near, load, 0.0)))
    if load[here] < _COSTS * float(load @ np.diff(s)):
        return None
    joint = int(np.argmax(shares[here]))
    at = here if smallest[here] < smallest[here + 1] else here + 1
    return Nearest(float(s[at]), float(smallest[at]), joint, float(slope[here, joint] / extent), turns)
