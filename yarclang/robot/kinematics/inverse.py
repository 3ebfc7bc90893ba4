"""Joint positions for poses: the one nearest to a seed, or all branches. For whole batches.

Arms with a spherical wrist or three parallel axes have a closed form, a calibrated arm starts from that of the arm it was meant to be, and any other arm of six turning
joints has its solutions by elimination. All others go by numeric search.
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
"""How many solutions the numeric search keeps."""

RESTARTS = 48
"""From how many joint positions it starts."""

POLISH = 1e-10
"""A solution that misses by more [m or rad] is improved by iteration."""

REACHED = 1e-9
"""The miss [m or rad] up to which a joint position counts as a solution."""

NEARLY_REACHED = 1e-6
"""The same for an arm with fewer than six joints. The poses that it reaches are a thin set: axes that are parallel but for
the last digits of a URDF, or a pose typed with some decimals, would leave nothing of it."""

NEARLY_REACHES = 0.05
"""A nominal solution of a calibrated arm that misses by less [m and rad] may have a solution next to it."""

REGULAR = 0.03
"""A smallest singular value of a Jacobian [m and rad] above which a solution keeps its place when an arm is calibrated."""

STRETCHED = 1.0
"""What a branch that doesn't reach the pose costs against one that does, in squared joint differences: a
seed at the edge of the workspace stays on its own branch instead of jumping to another."""


def reached_within(chain: Chain) -> float:
    """The miss [m or rad] up to which a joint position counts as a solution."""
    return REACHED if chain.size >= 6 else NEARLY_REACHED


def follow(chain: Chain, base_from_flange: Array, seeds: Array) -> tuple[Array, Array, Array]:
    """The solution nearest to each seed.

    With a closed form: of all branches and full turns the one with the least sum of squared joint
    differences; where the wrist is straight (or the wrist centre over axis 1) the seed's q4 (q1)
    is kept. Otherwise damped least squares from the seed, on the seed's own full turn. Limits aren't
    looked at.

    Args:
        chain: the arm, n joints.
        base_from_flange: (N, 4, 4).
        seeds: (N, n) [rad or m].

    Returns:
        q (N, n) [rad or m], and what it misses the poses by, measured by forward kinematics: position
        (N,) [m] and angle (N,) [rad]. Both under 1e-10 where the pose can be reached; where it can't, q
        is the nearest miss found.
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
    rough = np.flatnonzero(np.maximum(miss_position, miss_angle) > POLISH)
    if len(rough):
        better = fit(chain, base_from_flange[rough], q[rough])
        q[rough] = better.q
        miss_position[rough], miss_angle[rough] = better.miss_position, better.miss_angle
    return q, miss_position, miss_angle


def branches(
    chain: Chain, base_from_flange: Array, hold: Array | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """All solutions of each pose, without regard to limits.

    With a closed form these are its eight branches, always in the same order, so that along a path one index
    is one configuration as long as no singularity is passed. A calibrated arm's first eight are next to those
    of the arm as it was meant. Any other arm of six turning joints has its isolated solutions, 16 at most, in the
    order of their joint values. Otherwise, and for a pose at which that finds none, these are the solutions that a search from 48
    fixed joint positions finds, at most 16 and different from each other, in the order found.

    Args:
        chain: the arm, n joints.
        base_from_flange: (N, 4, 4).
        hold: (n,) [rad], the joint positions that a singular q4 or q1 takes; zeros if None.

    Returns:
        q (N, B, n), revolute joints in (-pi, pi] [rad], and which of them reach their pose (N, B).
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
    """Return True if `branches` has all isolated solutions of a pose: an arm of six turning joints."""
    return chain.size == 6 and links_of(chain).uniform


def _as_meant(chain: Chain, meant: Form, base_from_flange: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return a calibrated arm's solutions (N, B, 6) [rad], those next to its nominal closed form's first, and which of them there are (N, B).

    Where two of these meet, or are about to, the calibrated arm may have more or fewer: there all others come by elimination.
    """
    count = len(base_from_flange)
    nominal = closed_form(meant, base_from_flange, np.zeros((6, 1)))
    poses = np.repeat(base_from_flange, 8, axis=0)
    seeds = nominal.q.transpose(2, 1, 0).reshape(-1, 6)
    apart = misses(walk(chain, np.ascontiguousarray(seeds.T), np.eye(4))[0], pose_columns(poses))
    is_near = np.hypot(*apart) < NEARLY_REACHES
    found, miss = seeds.copy(), np.full(len(seeds), np.inf)
    found[is_near], miss[is_near] = polished(chain, poses[is_near], seeds[is_near])
    jacobians = walk_with_jacobian(chain, np.ascontiguousarray(found.T), np.eye(4))[1].transpose(2, 0, 1)
    is_regular = np.linalg.svd(jacobians, compute_uv=False)[:, -1] > REGULAR
    is_plain = (is_near == nominal.valid.T.ravel()) & (~is_near | ((miss < REACHED) & is_regular))
    q = np.zeros((count, 8 + MOST, 6))
    valid = np.zeros((count, 8 + MOST), dtype=bool)
    q[:, :8], valid[:, :8] = wrapped(chain, found).reshape(count, 8, 6), (miss < REACHED).reshape(count, 8)
    doubtful = np.flatnonzero(~is_plain.reshape(count, 8).all(axis=1))
    if len(doubtful):
        q[doubtful, 8:], valid[doubtful, 8:] = every_solution(chain, base_from_flange[doubtful])
    return q, valid & ~_repeated(chain, q, valid)


def _found_by_search(chain: Chain, base_from_flange: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return solutions of poses (N, BRANCHES, n) by numeric search, and which of them there are (N, BRANCHES)."""
    count, size = len(base_from_flange), chain.size
    starts = np.tile(restarts(chain, RESTARTS), (count, 1))
    poses = np.repeat(base_from_flange, RESTARTS, axis=0)
    fitted = fit(chain, poses, starts)
    q = wrapped(chain, fitted.q).reshape(count, RESTARTS, size)
    reached = (fitted.total < reached_within(chain)).reshape(count, RESTARTS)
    first = reached & ~_repeated(chain, q, reached)
    # those found first, in their order, then the rest as fillers
    order = np.argsort(~first, axis=1, kind="stable")[:, :BRANCHES]
    return np.take_along_axis(q, order[:, :, None], axis=1), np.take_along_axis(first, order, axis=1)


def restarts(chain: Chain, count: int) -> Array:
    """Fixed joint positions (count, n) [rad or m] to start a search from, spread evenly (a Halton
    sequence).
    """
    index = np.arange(1, count + 1)
    spread = np.stack([_radical_inverse(index, prime) for prime in _PRIMES[: chain.size]], axis=1)
    reach = np.where(chain.is_prismatic, extent(chain), math.pi)
    result: Array = (2.0 * spread - 1.0) * reach
    return result


def extent(chain: Chain) -> float:
    """The sum of the distances from joint to joint and to the flange [m], a size of the arm."""
    links = links_of(chain)
    points = np.vstack([links.frames[:, :3, 3], chain.base_from_flange[None, :3, 3]])
    # the point of a prismatic joint means nothing: its neighbour's stands in
    for joint in range(chain.size - 1, -1, -1):
        if not links.turn[joint]:
            points[joint] = points[joint + 1]
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) + 1e-3


def wrapped(chain: Chain, q: Array) -> Array:
    """`q` (..., n) with revolute joints in (-pi, pi]."""
    result: Array = q - np.where(chain.is_prismatic, 0.0, TURN * np.round(q / TURN))
    return result


def _nearest_branch(arm: Form, poses: Array, seed: Array) -> Array:
    """Of all branches and full turns the nearest (6, N) to `seed` (6, N)."""
    q, sure = nearest_form(arm, poses, seed)
    if not sure.all():
        rest = np.flatnonzero(~sure)
        q[:, rest] = _nearest_of_all(arm, poses[rest], np.ascontiguousarray(seed[:, rest]))
    return q


def _nearest_of_all(arm: Form, poses: Array, seed: Array) -> Array:
    """The same, by looking at all of them."""
    found = closed_form(arm, poses, seed)
    near, away = next_to(found.q, seed[:, None])
    cost = np.einsum("jbn,jbn->bn", away, away)
    cost[~found.valid] += STRETCHED
    best = np.argmin(cost, axis=0)
    result: Array = near[:, best, np.arange(len(best))]
    return result


def _repeated(chain: Chain, q: Array, reached: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which of the solutions (N, R, n) are the same as one before them (N, R)."""
    count = q.shape[1]
    away = np.abs(wrapped(chain, q[:, :, None] - q[:, None])).max(axis=3)
    earlier = np.tri(count, k=-1, dtype=bool)
    same: NDArray[np.bool_] = ((away < APART) & earlier & reached[:, None, :]).any(axis=2)
    return same


_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


def _radical_inverse(index: NDArray[np.int_], base: int) -> Array:
    """The digits of `index` to `base`, mirrored at the point (N,), in [0, 1)."""
    result, scale, left = np.zeros(len(index)), 1.0 / base, index.copy()
    while left.any():
        left, digit = np.divmod(left, base)
        result += digit * scale
        scale /= base
    return result
