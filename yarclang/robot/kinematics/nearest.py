"""Find the solutions of one pose within limits, the nearest first. If there is none, find the reason."""

from __future__ import annotations

import itertools
import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.kinematics.closed_form import closed_form
from yarclang.robot.kinematics.elimination import APART, polished
from yarclang.robot.kinematics.fk import walk, walk_with_jacobian
from yarclang.robot.kinematics.geometry import WristedArm, form_of
from yarclang.robot.kinematics.inverse import branches, has_all, reached_within, restarts, wrapped
from yarclang.robot.kinematics.nearest_spare import nearest_along
from yarclang.robot.kinematics.numeric import fit, misses, pose_columns
from yarclang.robot.kinematics.postures import spread
from yarclang.robot.kinematics.pulling import nearest_pulled, pulled_to
from yarclang.robot.kinematics.single import pose_with_jacobian
from yarclang.robot.kinematics.spare import spare_form
from yarclang.robot.kinematics.within import EDGE, beyond, nearest_turn
from yarclang.robot.kinematics.wrist import TURN
from yarclang.robot.model import Array, Chain, Limits
from yarclang.transforms import sealed

SAME = APART
"""Solutions that differ by less than this in every joint [rad or m], apart from full turns, count as one
solution.
"""

STANDS = 1e-7
"""Squared joint difference up to which a solution counts as equal to the reference."""

SEARCHES = 96
"""Number of starts of the numeric search within limits."""

FREE = 1e-5
"""Smallest singular value of a Jacobian [m and rad] below which a pose may leave a joint free."""

ORIENTATION = 30.0
"""Weight of 1 rad relative to 1 m in the search for the nearest miss. It is large, so that the orientation is
kept.
"""


@frozen(eq=False)
class Solutions:
    """Joint positions that reach a pose within limits: `q` (m, n) [rad or m], nearest to the reference first.

    `q` has one row for each branch, on its full turns nearest to the reference. The function `full_turns`
    lists the positions on the other full turns.
    """

    q: Array


@frozen(eq=False)
class Unreachable:
    """The reason why no joint position reaches a pose.

    Attributes:
        kind: "reach" if the pose is out of reach; "limits" if all its solutions exceed joint limits.
        q: (n,) joint position of the nearest miss for "reach" [rad or m], or the reference if the miss isn't
            measured; for "limits", the solution that exceeds limits least.
        miss: for "reach", the smallest distance of the frame's origin from that of the pose, with the frame
            turned as the pose is [m].
        miss_angle: for "reach", the remaining angle if the arm can't reach the orientation either [rad].
        joint: for "limits", the number of the joint that exceeds its limit, from 0.
        excess: for "limits", by how much it exceeds the limit [rad or m]: positive above the upper limit,
            negative below the lower limit.
        is_measured: True if `miss` and `miss_angle` are valid.
    """

    kind: Literal["reach", "limits"]
    q: Array
    miss: float = 0.0
    miss_angle: float = 0.0
    joint: int | None = None
    excess: float = 0.0
    is_measured: bool = True


def nearest_solutions(
    chain: Chain,
    limits: Limits,
    base_from_flange: Array,
    reference: Array,
    *,
    measures: bool = True,
    is_only: bool = False,
) -> Solutions | Unreachable:
    """Find all solutions within limits, sorted by their sum of squared joint differences from `reference`.

    Solutions at equal distances are sorted by their joint values, the first joint first. If the wrist is
    straight, the pose determines only the combined turn of joints 4 and 6: q4 stays at the reference, unless
    joint 6 would exceed a limit. A redundant arm has a continuum of solutions. For such an arm, the result
    contains the nearest solutions that a search from fixed starts finds, clear of limits if possible.

    Args:
        chain: the arm, n joints.
        limits: its limits.
        base_from_flange: (4, 4).
        reference: (n,) [rad or m].
        measures: True to compute by how much a pose is out of reach.
        is_only: True if only the nearest solution is needed. For a redundant arm this takes half the time,
            and other solutions may be missing.

    Returns:
        The solutions, or the reason why there is none.
    """
    reference = np.asarray(reference, dtype=float)
    if form_of(chain) is None:
        solutions = _searched(chain, limits, base_from_flange, reference, is_only)
    else:
        solutions = _in_closed_form(chain, limits, base_from_flange, reference)
    if not len(solutions):
        if not measures:
            return Unreachable("reach", sealed(reference), is_measured=False)
        return _out_of_reach(chain, base_from_flange, reference)
    lifted = nearest_turn(chain, limits, solutions, reference)
    excess = beyond(limits, lifted)
    inside = np.abs(excess).max(axis=1) <= EDGE
    if not inside.any():
        least = int(np.argmin(np.square(excess).sum(axis=1)))
        joint = int(np.argmax(np.abs(excess[least])))
        return Unreachable("limits", sealed(lifted[least]), joint=joint, excess=float(excess[least, joint]))
    q = np.clip(lifted[inside], limits.lower, limits.upper)
    cost = np.square(q - reference).sum(axis=1)
    # sort by rounded distances, so that the last bit doesn't decide between equal ones
    keys = [np.round(q[:, joint], 9) for joint in range(chain.size - 1, -1, -1)]
    q = q[np.lexsort((*keys, np.round(cost, 9)))]
    return Solutions(sealed(q[_distinct(chain, q)]))


def surely_reached(chain: Chain, limits: Limits, base_from_flange: Array) -> NDArray[np.bool_]:
    """Return a mask (N,) of the poses (N, 4, 4) for which `nearest_solutions` certainly finds a solution.

    False means only that `nearest_solutions` has to be called to find out. The mask is False for all arms
    without a closed form, and for poses at which a singularity leaves a joint free.
    """
    arm = form_of(chain)
    sure = np.zeros(len(base_from_flange), dtype=bool)
    if arm is None:
        return sure
    found = closed_form(arm, base_from_flange, np.zeros((chain.size, 1)))
    q = found.q.transpose(2, 1, 0)
    lifted = nearest_turn(chain, limits, q, np.zeros(chain.size))
    is_within = (np.abs(beyond(limits, lifted)) <= EDGE).all(axis=2)
    may_be = (found.valid & ~found.singular).T & is_within
    rows = np.flatnonzero(may_be.any(axis=1))
    candidates = q[rows, np.argmax(may_be[rows], axis=1)]
    sure[rows] = _reaching(chain, base_from_flange[rows], candidates)
    return sure


def full_turns(chain: Chain, limits: Limits, q: Array) -> Array:
    """Return all joint positions (m, n) within limits that differ from `q` (n,) by full turns of revolute
    joints.
    """
    choices = []
    for joint, value in enumerate(q):
        if chain.is_prismatic[joint]:
            choices.append([float(value)])
            continue
        # Without limits, at most eight full turns to either side.
        low = max(limits.lower[joint], value - 8.0 * TURN)
        high = min(limits.upper[joint], value + 8.0 * TURN)
        first = math.ceil((low - value - EDGE) / TURN)
        last = math.floor((high - value + EDGE) / TURN)
        choices.append([float(value + TURN * turn) for turn in range(first, last + 1)])
    found = np.array(list(itertools.product(*choices)), dtype=float).reshape(-1, chain.size)
    return sealed(np.clip(found, limits.lower, limits.upper))


def nearest_miss(chain: Chain, base_from_flange: Array, seeds: Array) -> tuple[Array, float, float]:
    """Find the joint position at which the arm comes nearest to a pose that it can't reach. The orientation
    of the pose is kept if possible.

    Args:
        chain: the arm, n joints.
        base_from_flange: (4, 4).
        seeds: (m, n) [rad or m], where the search starts.

    Returns:
        q (n,) [rad or m], the distance from the pose [m], and the remaining angle [rad]: the best result from
        all seeds.
    """
    poses = np.broadcast_to(base_from_flange, (len(seeds), 4, 4))
    found = fit(chain, poses, seeds, rounds=300, angle_weight=ORIENTATION)
    best = int(np.argmin(np.hypot(found.miss_position, ORIENTATION * found.miss_angle)))
    return found.q[best], float(found.miss_position[best]), float(found.miss_angle[best])


def _in_closed_form(chain: Chain, limits: Limits, pose: Array, reference: Array) -> Array:
    """Return the branches (m, n) of the closed form that reach the pose. If the wrist is straight and joint 6
    exceeds its limit, the excess is moved to joint 4.
    """
    arm = form_of(chain)
    assert arm is not None
    start = np.clip(reference, limits.lower, limits.upper)
    found = closed_form(arm, pose[None], start[:, None])
    valid = found.valid[:, 0]
    q, straight = found.q[:, valid, 0].T, found.singular[valid, 0]
    if straight.any() and isinstance(arm, WristedArm):
        lifted = nearest_turn(chain, limits, q, reference)
        axes = walk(chain, np.ascontiguousarray(q.T), np.eye(4))[1]
        # if the wrist is straight, axes 4 and 6 are the same line, in the same or in opposite directions
        sense = np.sign(np.einsum("kn,kn->n", axes[3], axes[5]))
        # move the excess of joint 6 to joint 4, which doesn't change the pose
        excess = np.where(straight, beyond(limits, lifted)[:, 5], 0.0)
        moved = lifted.copy()
        moved[:, 5] -= excess
        moved[:, 3] += sense * excess
        q = np.where((excess != 0.0)[:, None], moved, q)
    return q[_reaching(chain, pose[None], q)]


def _searched(chain: Chain, limits: Limits, pose: Array, reference: Array, is_only: bool) -> Array:
    """Return solutions (m, n) of a pose for an arm without a closed form: within limits if there are any,
    otherwise without regard to limits.
    """
    start = np.clip(reference, limits.lower, limits.upper)
    if has_all(chain):
        q = _isolated(chain, limits, pose, reference, start)
        if q is not None:
            return q
    spare, along = spare_form(chain), np.empty((0, chain.size))
    if spare is not None:
        along = nearest_along(chain, limits, spare, pose, start)
        if len(along) and not _is_loose(chain, start, along):
            return along
    if chain.size > 6:
        pulled = nearest_pulled(chain, limits, pose, start, is_only=is_only)
        if len(pulled):
            return np.vstack([along, pulled])
    free, reached = branches(chain, pose[None])
    from_reference = fit(chain, pose[None], start[None])
    q = np.vstack(
        [along, free[0][reached[0]], from_reference.q[from_reference.total < reached_within(chain)]]
    )
    # if a redundant arm misses the pose even without limits, it also misses the pose within limits
    if chain.size > 6 and not len(q):
        return q
    q = np.vstack([q, _found_within(chain, limits, pose, start)])
    if chain.size > 6:
        turned = nearest_turn(chain, limits, q, reference)
        inside = np.abs(beyond(limits, turned)).max(axis=1) <= EDGE
        if inside.any():
            q = turned[inside]
            pulled = pulled_to(chain, limits, pose, q, start)
            q = pulled if len(pulled) else q
    return q


def _found_within(chain: Chain, limits: Limits, pose: Array, start: Array) -> Array:
    """Return solutions (m, n) within limits, found from `start` (n,) and from joint positions spread over the
    limits.
    """
    even = spread(chain, limits.lower, limits.upper, start, SEARCHES)
    seeds = np.vstack([start, even])
    poses = np.broadcast_to(pose, (len(seeds), 4, 4))
    clipped = fit(chain, poses, seeds, lower=limits.lower, upper=limits.upper)
    found: Array = clipped.q[clipped.total < reached_within(chain)]
    return found


def _is_loose(chain: Chain, reference: Array, q: Array) -> bool:
    """Return True if the pose leaves a second joint free, in addition to the spare joint (the one joint more
    than the pose needs). This is tested at the joint position of `q` (m, 7) that is nearest to the reference.

    Return False if that joint position is the reference itself.
    """
    away = np.square(q - reference).sum(axis=1)
    nearest = q[int(np.argmin(away))]
    if away.min() < STANDS:
        return False
    jacobian = pose_with_jacobian(chain, nearest)[1]
    return bool(np.linalg.svd(jacobian, compute_uv=False)[-1] < FREE)


def _isolated(chain: Chain, limits: Limits, pose: Array, reference: Array, start: Array) -> Array | None:
    """Return all solutions (m, 6) of a pose for an arm of six turning joints, or None if others may exist.

    Others may exist if no solution is found. They may also exist if the pose leaves a joint free, unless a
    solution is within limits and iteration from `start` arrives at the pose.
    """
    found, reached = branches(chain, pose[None])
    # iterate from the start, too: the start, or a solution near it, may belong to a continuum of solutions
    from_start, miss = polished(chain, pose[None], start[None])
    q = np.vstack([found[0][reached[0]], from_start[miss < reached_within(chain)]])
    if not len(q):
        return None
    jacobian = walk_with_jacobian(chain, np.ascontiguousarray(q.T), np.eye(4))[1].transpose(2, 0, 1)
    if np.linalg.svd(jacobian, compute_uv=False)[:, -1].min() > FREE:
        return q
    lifted = nearest_turn(chain, limits, q, reference)
    inside = np.abs(beyond(limits, lifted)).max(axis=1) <= EDGE
    return q if inside.any() and miss[0] < reached_within(chain) else None


def _out_of_reach(chain: Chain, pose: Array, reference: Array) -> Unreachable:
    """Return the reason that a pose is out of reach, with the nearest miss found from the reference and from
    fixed starts.
    """
    seeds = np.vstack([reference, restarts(chain, 48)])
    arm = form_of(chain)
    if arm is not None:
        seeds = np.vstack([closed_form(arm, pose[None], reference[:, None]).q[:, :, 0].T, seeds])
    q, miss, miss_angle = nearest_miss(chain, pose, seeds)
    return Unreachable("reach", sealed(q), miss=miss, miss_angle=miss_angle)


def _reaching(chain: Chain, poses: Array, q: Array) -> NDArray[np.bool_]:
    """Return a mask (m,) of the joint positions (m, n) that reach their poses, by forward kinematics.

    The poses are (m, 4, 4), or (1, 4, 4) if all joint positions have the same pose.
    """
    columns = walk(chain, np.ascontiguousarray(q.T), np.eye(4))[0]
    position, angle = misses(columns, pose_columns(poses))
    reaching: NDArray[np.bool_] = np.maximum(position, angle) < reached_within(chain)
    return reaching


def _distinct(chain: Chain, q: Array) -> NDArray[np.bool_]:
    """Return a mask (m,) of the rows of `q` (m, n) that repeat no earlier row, not even shifted by full
    turns.
    """
    away = np.abs(wrapped(chain, q[:, None] - q[None])).max(axis=2)
    same: NDArray[np.bool_] = ((away < SAME) & np.tri(len(q), k=-1, dtype=bool)).any(axis=1)
    return ~same
