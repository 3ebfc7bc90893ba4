"""The solutions of one pose within limits, nearest first; or why there is none."""

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
"""Solutions nearer to each other than this in every joint [rad or m], but for full turns, are one."""

STANDS = 1e-7
"""A squared joint difference from the reference up to which a solution is the reference itself."""

SEARCHES = 96
"""Starts of the numeric search within limits."""

FREE = 1e-5
"""A smallest singular value of a Jacobian [m and rad] under which a pose may leave a joint free."""

ORIENTATION = 30.0
"""What 1 rad counts against 1 m where the nearest miss with the orientation held is looked for."""


@frozen(eq=False)
class Solutions:
    """Joint positions that reach a pose within limits: `q` (m, n) [rad or m], nearest to the reference first.

    One for each branch, on its nearest full turns; `full_turns` lists the others.
    """

    q: Array


@frozen(eq=False)
class Unreachable:
    """Why no joint position reaches a pose.

    kind "reach": the frame misses by `miss` [m] at least, its orientation held; where the arm can't
    even hold that, `miss_angle` [rad] is what is left. Neither is known unless `is_measured`. kind "limits": the solution that needs least has
    `joint` (from 0) beyond its limit by `excess` [rad or m], above the upper one if positive, below the
    lower one if negative. `q` (n,) is the joint position in question [rad or m].
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
    """All solutions within limits, by their sum of squared joint differences from `reference`.

    Equal distances are ordered by the joint values, the first joint first. Where the wrist is straight q4
    is the reference's and q6 makes up the sum (only a limit of joint 6 moves q4). A redundant arm has a
    continuum of solutions: the nearest that a search from fixed starts finds, clear of limits where it can be.

    Args:
        chain: the arm, n joints.
        limits: its limits.
        base_from_flange: (4, 4).
        reference: (n,) [rad or m].
        measures: True to search for how far a pose is out of reach.
        is_only: True if only the nearest is wanted: of a redundant arm, which takes half the time, others may be missing.

    Returns:
        The solutions, or the reason why there is none.
    """
    reference = np.asarray(reference, dtype=float)
    if form_of(chain) is None:
        found = _searched(chain, limits, base_from_flange, reference, is_only)
    else:
        found = _in_closed_form(chain, limits, base_from_flange, reference)
    if not len(found):
        if not measures:
            return Unreachable("reach", sealed(reference), is_measured=False)
        return _out_of_reach(chain, base_from_flange, reference)
    lifted = nearest_turn(chain, limits, found, reference)
    excess = beyond(limits, lifted)
    inside = np.abs(excess).max(axis=1) <= EDGE
    if not inside.any():
        least = int(np.argmin(np.square(excess).sum(axis=1)))
        joint = int(np.argmax(np.abs(excess[least])))
        return Unreachable("limits", sealed(lifted[least]), joint=joint, excess=float(excess[least, joint]))
    q = np.clip(lifted[inside], limits.lower, limits.upper)
    cost = np.square(q - reference).sum(axis=1)
    # rounded, so that the last bit doesn't decide between equals
    keys = [np.round(q[:, joint], 9) for joint in range(chain.size - 1, -1, -1)]
    q = q[np.lexsort((*keys, np.round(cost, 9)))]
    return Solutions(sealed(q[_distinct(chain, q)]))


def surely_reached(chain: Chain, limits: Limits, base_from_flange: Array) -> NDArray[np.bool_]:
    """Return True (N,) for each pose (N, 4, 4) for which `nearest_solutions` has a solution, as far as that is seen without a closer look.

    None is seen of arms without a closed form, nor where a singularity leaves a joint free.
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
    """All joint positions (m, n) within limits that differ from `q` (n,) by full turns of revolute joints."""
    choices = []
    for joint, value in enumerate(q):
        if chain.is_prismatic[joint]:
            choices.append([float(value)])
            continue
        low = max(limits.lower[joint], value - 8.0 * TURN)
        high = min(limits.upper[joint], value + 8.0 * TURN)
        first = math.ceil((low - value - EDGE) / TURN)
        last = math.floor((high - value + EDGE) / TURN)
        choices.append([float(value + TURN * turn) for turn in range(first, last + 1)])
    found = np.array(list(itertools.product(*choices)), dtype=float).reshape(-1, chain.size)
    return sealed(np.clip(found, limits.lower, limits.upper))


def nearest_miss(chain: Chain, base_from_flange: Array, seeds: Array) -> tuple[Array, float, float]:
    """Where the arm comes nearest to a pose that it can't reach, its orientation held.

    Returns:
        q (n,), the miss [m], and the turn that is left [rad], the best from `seeds` (m, n).
    """
    poses = np.broadcast_to(base_from_flange, (len(seeds), 4, 4))
    found = fit(chain, poses, seeds, rounds=300, angle_weight=ORIENTATION)
    best = int(np.argmin(np.hypot(found.miss_position, ORIENTATION * found.miss_angle)))
    return found.q[best], float(found.miss_position[best]), float(found.miss_angle[best])


def _in_closed_form(chain: Chain, limits: Limits, pose: Array, reference: Array) -> Array:
    """The branches (m, n) that reach the pose, a straight wrist's last turn shared where joint 6 has to."""
    arm = form_of(chain)
    assert arm is not None
    start = np.clip(reference, limits.lower, limits.upper)
    found = closed_form(arm, pose[None], start[:, None])
    valid = found.valid[:, 0]
    q, straight = found.q[:, valid, 0].T, found.singular[valid, 0]
    if straight.any() and isinstance(arm, WristedArm):
        lifted = nearest_turn(chain, limits, q, reference)
        axes = walk(chain, np.ascontiguousarray(q.T), np.eye(4))[1]
        sense = np.sign(np.einsum("kn,kn->n", axes[3], axes[5]))
        excess = np.where(straight, beyond(limits, lifted)[:, 5], 0.0)
        moved = lifted.copy()
        moved[:, 5] -= excess
        moved[:, 3] += sense * excess
        q = np.where((excess != 0.0)[:, None], moved, q)
    return q[_reaching(chain, pose[None], q)]


def _searched(chain: Chain, limits: Limits, pose: Array, reference: Array, is_only: bool) -> Array:
    """Solutions (m, n) by numeric search; within limits if there are any, else without regard to them."""
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
    # with more joints than the pose needs: what isn't reached without limits isn't within them
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
    """Return solutions (m, n) within limits that are found from joint positions spread over these, and from one (n,)."""
    even = spread(chain, limits.lower, limits.upper, start, SEARCHES)
    seeds = np.vstack([start, even])
    poses = np.broadcast_to(pose, (len(seeds), 4, 4))
    clipped = fit(chain, poses, seeds, lower=limits.lower, upper=limits.upper)
    found: Array = clipped.q[clipped.total < reached_within(chain)]
    return found


def _is_loose(chain: Chain, reference: Array, q: Array) -> bool:
    """Return True if the nearest of joint positions (m, n) of an arm with one spare joint leaves another one free, and isn't the reference itself."""
    away = np.square(q - reference).sum(axis=1)
    nearest = q[int(np.argmin(away))]
    if away.min() < STANDS:
        return False
    jacobian = pose_with_jacobian(chain, nearest)[1]
    return bool(np.linalg.svd(jacobian, compute_uv=False)[-1] < FREE)


def _isolated(chain: Chain, limits: Limits, pose: Array, reference: Array, start: Array) -> Array | None:
    """Return all solutions (m, 6) of an arm of six turning joints; None where there may be others: none is found, or those that are leave a joint free and are out of limits."""
    found, reached = branches(chain, pose[None])
    # a continuum goes through the reference, or near it
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
    """The nearest miss from the reference and from fixed starts."""
    seeds = np.vstack([reference, restarts(chain, 48)])
    arm = form_of(chain)
    if arm is not None:
        seeds = np.vstack([closed_form(arm, pose[None], reference[:, None]).q[:, :, 0].T, seeds])
    q, miss, miss_angle = nearest_miss(chain, pose, seeds)
    return Unreachable("reach", sealed(q), miss=miss, miss_angle=miss_angle)


def _reaching(chain: Chain, poses: Array, q: Array) -> NDArray[np.bool_]:
    """Which of the joint positions (m, n) reach their poses (m, 4, 4), or the only pose (1, 4, 4), by forward kinematics."""
    columns = walk(chain, np.ascontiguousarray(q.T), np.eye(4))[0]
    position, angle = misses(columns, pose_columns(poses))
    reaching: NDArray[np.bool_] = np.maximum(position, angle) < reached_within(chain)
    return reaching


def _distinct(chain: Chain, q: Array) -> NDArray[np.bool_]:
    """Return the rows of `q` (m, n) that aren't the same as one before them, but for full turns."""
    away = np.abs(wrapped(chain, q[:, None] - q[None])).max(axis=2)
    same: NDArray[np.bool_] = ((away < SAME) & np.tri(len(q), k=-1, dtype=bool)).any(axis=1)
    return ~same
