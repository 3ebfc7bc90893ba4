"""Find joint positions for many poses at once: the solution nearest to a seed, or all solutions.

Arms with a spherical wrist or three parallel axes have a closed form. For a calibrated arm, iteration starts
from the closed form of its nominal arm. Any other arm of six turning joints is solved by elimination, and all
remaining arms by numeric search.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from yarclang.progress import go_on
from yarclang.robot.kinematics.closed_form import BLOCK, closed_form, nearest_form, next_to
from yarclang.robot.kinematics.elimination import APART, MOST, every_solution, polished
from yarclang.robot.kinematics.fk import links_of, walk, walk_with_jacobian
from yarclang.robot.kinematics.geometry import Form, form_of, nominal_form
from yarclang.robot.kinematics.numeric import fit, misses, pose_columns
from yarclang.robot.kinematics.wrist import TURN
from yarclang.robot.model import Array, Chain

BRANCHES = 16
"""The largest number of solutions of a pose that the numeric search keeps."""

RESTARTS = 48
"""Number of joint positions from which the numeric search starts."""

POLISH = 1e-10
"""A solution that misses its pose by more than this [m or rad] is improved by iteration."""

REACHED = 1e-9
"""The miss [m or rad] up to which a joint position counts as a solution."""

NEARLY_REACHED = 1e-6
"""For an arm with fewer than six joints, the miss up to which a joint position counts as a solution [m or
rad].

Such an arm reaches only poses that satisfy one or more equations. Poses are typed with a few decimals, and
the axes in a URDF may be parallel only up to the last digits. With a tighter limit, hardly any typed pose
would count as reachable.
"""

NEARLY_REACHES = 0.05
"""A nominal solution of a calibrated arm is improved by iteration if it misses the pose by less than this [m
and rad].
"""

REGULAR = 0.03
"""If the smallest singular value of the Jacobian [m and rad] is above this, the solutions of the nominal and
of the calibrated arm differ only a little.
"""

STRETCHED = 1.0
"""Extra cost of a branch that doesn't reach the pose [squared joint differences]. It is finite, so that a
seed at the edge of the workspace stays on its own branch instead of jumping to another.
"""


def reached_within(chain: Chain) -> float:
    """Return the largest distance from a pose [m or rad] at which a joint position counts as its solution."""
    return REACHED if chain.size >= 6 else NEARLY_REACHED


def follow(chain: Chain, base_from_flange: Array, seeds: Array) -> tuple[Array, Array, Array]:
    """Find the solution nearest to each seed, without regard to limits.

    With a closed form, the solution is the branch and full turn with the least sum of squared joint
    differences. If the wrist is straight (or the wrist centre is on axis 1), the seed's q4 (or q1) is kept.
    Without a closed form, damped least squares start from the seed, and the solution stays on the seed's full
    turn.

    Args:
        chain: the arm, n joints.
        base_from_flange: (N, 4, 4).
        seeds: (N, n) [rad or m].

    Returns:
        q (N, n) [rad or m], and by how much it misses the poses by forward kinematics: position (N,) [m] and
        angle (N,) [rad]. Both are under 1e-10 if the pose can be reached; otherwise q is the nearest miss
        found.
    """
    arm = form_of(chain)
    if arm is None:
        found = fit(chain, base_from_flange, seeds)
        return found.q, found.miss_position, found.miss_angle
    q = np.empty((len(seeds), chain.size))
    miss_position, miss_angle = np.empty(len(seeds)), np.empty(len(seeds))
    for start in range(0, len(seeds), BLOCK):
        go_on()
        piece = slice(start, start + BLOCK)
        poses, seed = base_from_flange[piece], np.ascontiguousarray(seeds[piece].T)
        nearest = _nearest_branch(arm, poses, seed)
        columns = walk(chain, nearest, np.eye(4))[0]
        miss_position[piece], miss_angle[piece] = misses(columns, pose_columns(poses))
        q[piece] = nearest.T
    # improve solutions near a boundary or a singularity, and find the nearest miss of poses out of reach
    rough = np.flatnonzero(np.maximum(miss_position, miss_angle) > POLISH)
    if len(rough):
        better = fit(chain, base_from_flange[rough], q[rough])
        q[rough] = better.q
        miss_position[rough], miss_angle[rough] = better.miss_position, better.miss_angle
    return q, miss_position, miss_angle


def branches(
    chain: Chain, base_from_flange: Array, hold: Array | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """Find all solutions of each pose, without regard to limits.

    - With a closed form, the solutions are its eight branches. Their order never changes: along a path, one
      index is one configuration as long as no singularity is passed.
    - The first eight solutions of a calibrated arm are near those of its nominal arm.
    - Any other arm of six turning joints has its isolated solutions, at most 16, in the order of their joint
      values.
    - For all other arms, and for poses at which elimination finds nothing, the solutions come from a search
      that starts from 48 fixed joint positions: at most 16 distinct ones, in the order found.

    Args:
        chain: the arm, n joints.
        base_from_flange: (N, 4, 4).
        hold: (n,) [rad], the values for q4 and q1 if a singularity leaves them free; zeros if None.

    Returns:
        q (N, B, n) with revolute joints in (-pi, pi] [rad], and a mask (N, B) of the entries that reach their
        pose.
    """
    arm = form_of(chain)
    if arm is not None:
        held = np.zeros((6, 1)) if hold is None else hold[:, None]
        found = closed_form(arm, base_from_flange, held)
        return np.ascontiguousarray(found.q.transpose(2, 1, 0)), np.ascontiguousarray(found.valid.T)
    if not has_all(chain):
        return _found_by_search(chain, base_from_flange)
    go_on()
    meant = nominal_form(chain)
    if meant is None:
        q, valid = every_solution(chain, base_from_flange)
    else:
        q, valid = _as_meant(chain, meant, base_from_flange)
    none = np.flatnonzero(~valid.any(axis=1))
    if len(none):
        q[none, :BRANCHES], valid[none, :BRANCHES] = _found_by_search(chain, base_from_flange[none])
    return q, valid


def has_all(chain: Chain) -> bool:
    """Return True if `branches` finds all isolated solutions of a pose, as it does for arms of six turning
    joints.
    """
    return chain.size == 6 and links_of(chain).uniform


def _as_meant(chain: Chain, nominal_form: Form, base_from_flange: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the solutions of a calibrated arm, found by iteration from the solutions of its nominal arm.

    If two nominal solutions meet or nearly meet, the calibrated arm may have more or fewer solutions. For
    such a pose, elimination is used as well, to find all of them.

    Args:
        chain: the calibrated arm.
        nominal_form: the closed form of its nominal arm.
        base_from_flange: (N, 4, 4).

    Returns:
        q (N, B, 6) [rad], first those near the nominal solutions, and a mask (N, B) of the entries that are
        solutions.
    """
    count = len(base_from_flange)
    nominal = closed_form(nominal_form, base_from_flange, np.zeros((6, 1)))
    poses = np.repeat(base_from_flange, 8, axis=0)
    seeds = nominal.q.transpose(2, 1, 0).reshape(-1, 6)
    apart = misses(walk(chain, np.ascontiguousarray(seeds.T), np.eye(4))[0], pose_columns(poses))
    is_near = np.hypot(*apart) < NEARLY_REACHES
    solutions, miss = seeds.copy(), np.full(len(seeds), np.inf)
    solutions[is_near], miss[is_near] = polished(chain, poses[is_near], seeds[is_near])
    jacobians = walk_with_jacobian(chain, np.ascontiguousarray(solutions.T), np.eye(4))[1].transpose(2, 0, 1)
    is_regular = np.linalg.svd(jacobians, compute_uv=False)[:, -1] > REGULAR
    # a branch is plain if nominal and calibrated arm agree: both reach the pose, or neither comes near it
    is_plain = (is_near == nominal.valid.T.ravel()) & (~is_near | ((miss < REACHED) & is_regular))
    q = np.zeros((count, 8 + MOST, 6))
    valid = np.zeros((count, 8 + MOST), dtype=bool)
    q[:, :8], valid[:, :8] = (
        wrapped(chain, solutions).reshape(count, 8, 6),
        (miss < REACHED).reshape(count, 8),
    )
    doubtful = np.flatnonzero(~is_plain.reshape(count, 8).all(axis=1))
    if len(doubtful):
        q[doubtful, 8:], valid[doubtful, 8:] = every_solution(chain, base_from_flange[doubtful])
    return q, valid & ~_repeated(chain, q, valid)


def _found_by_search(chain: Chain, base_from_flange: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return solutions of poses (N, BRANCHES, n) found by numeric search, and a mask (N, BRANCHES) of the
    entries that are solutions.
    """
    count, size = len(base_from_flange), chain.size
    starts = np.tile(restarts(chain, RESTARTS), (count, 1))
    poses = np.repeat(base_from_flange, RESTARTS, axis=0)
    fitted = fit(chain, poses, starts)
    q = wrapped(chain, fitted.q).reshape(count, RESTARTS, size)
    reached = (fitted.total < reached_within(chain)).reshape(count, RESTARTS)
    first = reached & ~_repeated(chain, q, reached)
    # the distinct solutions come first, in the order found; the rest fills the array
    order = np.argsort(~first, axis=1, kind="stable")[:, :BRANCHES]
    return np.take_along_axis(q, order[:, :, None], axis=1), np.take_along_axis(first, order, axis=1)


def restarts(chain: Chain, count: int) -> Array:
    """Return fixed joint positions (count, n) [rad or m] from which to start a search, spread evenly by a
    Halton sequence.
    """
    index = np.arange(1, count + 1)
    spread = np.stack([_radical_inverse(index, prime) for prime in _PRIMES[: chain.size]], axis=1)
    reach = np.where(chain.is_prismatic, extent(chain), math.pi)
    result: Array = (2.0 * spread - 1.0) * reach
    return result


def extent(chain: Chain) -> float:
    """Return the size of the arm: the sum of the distances from joint to joint and to the flange [m]."""
    links = links_of(chain)
    points = np.vstack([links.frames[:, :3, 3], chain.base_from_flange[None, :3, 3]])
    # the origin of a prismatic joint's frame is arbitrary: use that of the next frame
    for joint in range(chain.size - 1, -1, -1):
        if not links.turn[joint]:
            points[joint] = points[joint + 1]
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) + 1e-3


def wrapped(chain: Chain, q: Array) -> Array:
    """Return `q` (..., n) with revolute joints in (-pi, pi]."""
    result: Array = q - np.where(chain.is_prismatic, 0.0, TURN * np.round(q / TURN))
    return result


def _nearest_branch(arm: Form, poses: Array, seed: Array) -> Array:
    """Return, for each pose, the solution (6, N) nearest to `seed` (6, N), of all branches and full turns.
    For a pose out of reach, return the joint position at which the arm stretches towards the pose.
    """
    q, sure = nearest_form(arm, poses, seed)
    if not sure.all():
        rest = np.flatnonzero(~sure)
        q[:, rest] = _nearest_of_all(arm, poses[rest], np.ascontiguousarray(seed[:, rest]))
    return q


def _nearest_of_all(arm: Form, poses: Array, seed: Array) -> Array:
    """Compute `_nearest_branch` by comparing all branches."""
    found = closed_form(arm, poses, seed)
    near, away = next_to(found.q, seed[:, None])
    cost = np.einsum("jbn,jbn->bn", away, away)
    cost[~found.valid] += STRETCHED
    best = np.argmin(cost, axis=0)
    result: Array = near[:, best, np.arange(len(best))]
    return result


def _repeated(chain: Chain, q: Array, reached: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a mask (N, R): True for each of the solutions (N, R, n) that repeats an earlier solution of the
    same pose.
    """
    count = q.shape[1]
    away = np.abs(wrapped(chain, q[:, :, None] - q[:, None])).max(axis=3)
    earlier = np.tri(count, k=-1, dtype=bool)
    same: NDArray[np.bool_] = ((away < APART) & earlier & reached[:, None, :]).any(axis=2)
    return same


_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


def _radical_inverse(index: NDArray[np.int_], base: int) -> Array:
    """Return the radical inverse of `index` (N,) as (N,) in [0, 1): the digits of the index in base `base`,
    mirrored at the radix point.
    """
    result, scale, left = np.zeros(len(index)), 1.0 / base, index.copy()
    while left.any():
        left, digit = np.divmod(left, base)
        result += digit * scale
        scale /= base
    return result
