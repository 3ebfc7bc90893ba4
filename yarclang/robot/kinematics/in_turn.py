"""The nearest solutions of many poses, each from the one before, found together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.kinematics.closed_form import closed_form
from yarclang.robot.kinematics.fk import walk
from yarclang.robot.kinematics.geometry import form_of
from yarclang.robot.kinematics.inverse import reached_within
from yarclang.robot.kinematics.numeric import misses, pose_columns
from yarclang.robot.kinematics.within import EDGE, beyond, nearest_turn
from yarclang.robot.kinematics.wrist import TURN
from yarclang.robot.model import Array, Chain, Limits

_CLEARLY = 1e-8
"""The nearest solution is nearer than all others by at least this [squared joint differences]."""


def nearest_in_turn(chain: Chain, limits: Limits, base_from_flange: Array, reference: Array) -> Array:
    """Return the solutions that `nearest_solutions` gives first, each with the one before as its reference, as far as there is nothing to decide.

    The arm is assumed to stay on one branch, which makes all references known at once. A pose counts only if its solution is then
    the nearest of all, clearly, and no angle is free there. An arm without a closed form has none.

    Args:
        chain: the arm, n joints.
        limits: its limits.
        base_from_flange: (N, 4, 4).
        reference: (n,) [rad or m], of the first pose.

    Returns:
        (k, n) [rad or m] for the first k poses, k at most N.
    """
    arm = form_of(chain)
    nothing = np.empty((0, chain.size))
    if arm is None or not len(base_from_flange):
        return nothing
    hold = np.clip(reference, limits.lower, limits.upper)
    found = closed_form(arm, base_from_flange, hold[:, None])
    q = np.ascontiguousarray(found.q.transpose(2, 1, 0))
    reaching = found.valid.T & _reach(chain, base_from_flange, q)
    first = _costs(chain, limits, q[:1], reaching[:1], reference[None])[1][0]
    branch = int(np.argmin(first))
    if not np.isfinite(first[branch]):
        return nothing
    turns = np.zeros((len(q), chain.size))
    turns[0] = np.round((nearest_turn(chain, limits, q[0, branch], reference) - q[0, branch]) / TURN)
    turns[1:] = turns[0] - np.cumsum(np.round(np.diff(q[:, branch], axis=0) / TURN), axis=0)
    along = q[:, branch] + TURN * turns
    clipped, costs = _costs(chain, limits, q, reaching, np.vstack([reference, along[:-1]]))
    own = costs[:, branch].copy()
    costs[:, branch] = np.inf
    is_sure = np.isfinite(own) & (own + _CLEARLY < costs.min(axis=1))
    is_sure &= (clipped[:, branch] == along).all(axis=1)
    is_sure &= ~(found.singular & found.valid).any(axis=0)
    return along[: len(along) if is_sure.all() else int(np.argmin(is_sure))]


def _costs(
    chain: Chain, limits: Limits, q: Array, reaching: NDArray[np.bool_], reference: Array
) -> tuple[Array, Array]:
    """Return the branches (N, B, n) on their turns nearest to `reference` (N, n), and their squared distances from it (N, B): none if out of limits."""
    lifted = nearest_turn(chain, limits, q, reference[:, None])
    inside = np.abs(beyond(limits, lifted)).max(axis=2) <= EDGE
    clipped = np.clip(lifted, limits.lower, limits.upper)
    costs = np.square(clipped - reference[:, None]).sum(axis=2)
    costs[~(inside & reaching)] = np.inf
    return clipped, costs


def _reach(chain: Chain, base_from_flange: Array, q: Array) -> NDArray[np.bool_]:
    """Return which branches `q` (N, B, n) reach their poses (N, 4, 4), by forward kinematics."""
    count, branches, size = q.shape
    columns = walk(chain, np.ascontiguousarray(q.reshape(-1, size).T), np.eye(4))[0]
    position, angle = misses(columns, pose_columns(np.repeat(base_from_flange, branches, axis=0)))
    reaching: NDArray[np.bool_] = np.maximum(position, angle) < reached_within(chain)
    return reaching.reshape(count, branches)
