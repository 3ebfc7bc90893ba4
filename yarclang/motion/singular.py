"""How near a path of the moving frame comes to a singularity, and what that costs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.motion.cartesian import CartesianPath
from yarclang.robot.kinematics.singularity import smallest_singular_values

NEAR = 0.06
"""Below this smallest singular value a path counts as near a singularity: far from one it is 0.1 to 0.5."""

_COSTS = 2.0
"""A joint that turns so many times as fast there as it does on the average costs something."""

_STILL = 1e-9


@dataclass(frozen=True, slots=True)
class Nearest:
    """The place `s` of a path that is nearest to a singularity: the smallest singular value there, and the `joint` that turns most,
    by `rate` [rad or m per m of the way, or per rad of a pure turn].
    """

    s: float
    smallest: float
    joint: int
    rate: float
    turns: bool


def nearest_singularity(path: CartesianPath) -> Nearest | None:
    """Where a path comes nearest to a singularity that costs it joint speed; None where it keeps away, or passes without a cost.

    The places are those at which the arm was followed: the nearer a singularity, the denser they are.
    """
    s, q = path.followed.s, path.followed.q
    smallest = smallest_singular_values(path.chain, q, path.flange_from_moving)
    if smallest.min() >= NEAR:
        return None
    slope = np.abs(np.diff(q, axis=0)) / np.diff(s)[:, None]
    average = np.abs(np.diff(q, axis=0)).sum(axis=0)
    # beside the place, not on it: exactly there the way may go through between two places
    peak = np.maximum(np.vstack((slope[:1], slope)), np.vstack((slope, slope[-1:])))
    near = np.flatnonzero(smallest < NEAR)
    here = int(near[np.argmax((peak[near] / np.maximum(average, 1e-3)).max(axis=1))])
    joint = int(np.argmax(peak[here] / np.maximum(average, 1e-3)))
    if peak[here, joint] < _COSTS * max(average[joint], 1e-3):
        return None
    extent, turns = path.extent
    if extent < _STILL:
        return None
    return Nearest(float(s[here]), float(smallest[here]), joint, float(peak[here, joint] / extent), turns)
