"""Find the solutions of many consecutive poses together, each solution being the nearest to the solution of
the previous pose.
"""

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
"""If the squared distances of the two nearest solutions from the reference differ by less than this, it is
uncertain which of the two is the nearest [squared joint differences].
"""


def nearest_in_turn(chain: Chain, limits: Limits, base_from_flange: Array, reference: Array) -> Array:
    """Return, for each pose, the solution nearest to the solution of the previous pose: the one that
    `nearest_solutions` returns first.

    All poses are solved at once, on the assumption that the arm stays in one configuration (branch). The
    result ends before the first pose at which this is uncertain, because another solution is as near, or the
    pose leaves an angle free. The result is empty for an arm without a closed form.

    Args:
        chain: the arm, n joints.
        limits: its limits.
        base_from_flange: (N, 4, 4).
        reference: (n,) [rad or m]; the first solution is the one nearest to it.

    Returns:
        (k, n) [rad or m] for the first k poses, k at most N.
    """
    arm = form_of(chain)
    nothing = np.empty((0, chain.size))
    if arm is None or not len(base_from_flange):
        return nothing
    hold = np.clip(reference, limits.lower, limits.upper)
    solutions = closed_form(arm, base_from_flange, hold[:, None])
    q = np.ascontiguousarray(solutions.q.transpose(2, 1, 0))
    reaching = solutions.valid.T & _reach(chain, base_from_flange, q)
    first = _costs(chain, limits, q[:1], reaching[:1], reference[None])[1][0]
    branch = int(np.argmin(first))
    if not np.isfinite(first[branch]):
        return nothing
    # unwrap the branch: shift its first joint position to the full turn nearest to the reference, and remove
    # the jumps by full turns between poses
    turns = np.zeros((len(q), chain.size))
    turns[0] = np.round((nearest_turn(chain, limits, q[0, branch], reference) - q[0, branch]) / TURN)
    turns[1:] = turns[0] - np.cumsum(np.round(np.diff(q[:, branch], axis=0) / TURN), axis=0)
    along = q[:, branch] + TURN * turns
    # compare with all other branches: the reference of each pose is the assumed solution of the previous pose
    clipped, costs = _costs(chain, limits, q, reaching, np.vstack([reference, along[:-1]]))
    own = costs[:, branch].copy()
    costs[:, branch] = np.inf
    is_sure = np.isfinite(own) & (own + _CLEARLY < costs.min(axis=1))
    is_sure &= (clipped[:, branch] == along).all(axis=1)
    # a pose that leaves an angle free is uncertain: `closed_form` takes the angle from the first reference,
    # not from the previous solution
    is_sure &= ~(solutions.singular & solutions.valid).any(axis=0)
    return along[: len(along) if is_sure.all() else int(np.argmin(is_sure))]


def _costs(
    chain: Chain, limits: Limits, q: Array, reaching: NDArray[np.bool_], reference: Array
) -> tuple[Array, Array]:
    """Return all branches (N, B, n), shifted to the full turns nearest to `reference` (N, n), and their
    squared distances from `reference` (N, B). The distance is infinite if a branch exceeds limits or misses
    its pose.
    """
    lifted = nearest_turn(chain, limits, q, reference[:, None])
    inside = np.abs(beyond(limits, lifted)).max(axis=2) <= EDGE
    clipped = np.clip(lifted, limits.lower, limits.upper)
    costs = np.square(clipped - reference[:, None]).sum(axis=2)
    costs[~(inside & reaching)] = np.inf
    return clipped, costs


def _reach(chain: Chain, base_from_flange: Array, q: Array) -> NDArray[np.bool_]:
    """Return a mask (N, B) of the branches `q` (N, B, n) that reach their poses (N, 4, 4), by forward
    kinematics.
    """
    count, branches, size = q.shape
    columns = walk(chain, np.ascontiguousarray(q.reshape(-1, size).T), np.eye(4))[0]
    position, angle = misses(columns, pose_columns(np.repeat(base_from_flange, branches, axis=0)))
    reaching: NDArray[np.bool_] = np.maximum(position, angle) < reached_within(chain)
    return reaching.reshape(count, branches)
