"""Find one joint position within limits for each of many poses, for any arm, without seed or reference.

If there is a closed form, its branches are tried. For a calibrated arm, the solutions near its nominal
solutions are tried first. Otherwise damped least squares start from some thousand fixed joint positions
within limits. For each pose, the first start is the one whose own pose is nearest; poses that are still
unsolved then try more starts.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.kinematics.closed_form import closed_form
from yarclang.robot.kinematics.elimination import polished
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.kinematics.geometry import Form, form_of, nominal_form
from yarclang.robot.kinematics.inverse import branches, extent, reached_within, restarts
from yarclang.robot.kinematics.numeric import fit
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.kinematics.within import EDGE, beyond, nearest_turn
from yarclang.robot.model import Array, Chain, Limits

STARTS = 2048
"""Number of fixed joint positions to start from."""

TURNED = 0.3
"""Weight of a turn by 1 rad relative to a distance of the arm's whole length, in the choice of the nearest
start.
"""

STAGES = ((1, 14), (2, 20), (6, 30), (24, 40), (64, 60), (160, 80))
"""For each stage of the search, the number of starts for each pose, and the largest number of steps from each
start. A start that hasn't converged after these steps seldom does.
"""

BLOCK = 512
"""Number of poses whose distances to all starts are computed together."""


def reaching(chain: Chain, limits: Limits, base_from_flange: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Find a joint position within limits for each pose. If there are several, any of them may be returned.

    If none is found, this doesn't prove that none exists.

    Args:
        chain: the arm, n joints.
        limits: position limits; a continuous joint ends up within half a turn of 0.
        base_from_flange: (N, 4, 4).

    Returns:
        q (N, n) [rad or m], and a mask (N,) of the entries that reach their poses within 1e-9 m and rad,
        inside the limits. The other entries are the last joint positions that were tried.
    """
    count = len(base_from_flange)
    if form_of(chain) is not None:
        solutions, valid = branches(chain, base_from_flange)
        solutions, inside = _within(chain, limits, solutions)
        good = valid & inside
        choice = np.argmax(good, axis=1)
        rows = np.arange(count)
        return solutions[rows, choice], good[rows, choice]
    q, solved = np.empty((count, chain.size)), np.zeros(count, dtype=bool)
    if (meant := nominal_form(chain)) is not None:
        q, solved = _next_to_meant(chain, meant, limits, base_from_flange)
    seeds = _start_positions(chain, limits)
    begun = 0
    for starts, rounds in STAGES:
        todo = np.flatnonzero(~solved)
        if not len(todo):
            break
        # continue with the starts that come after those of the earlier stages
        nearest = _nearest_starts(chain, limits, base_from_flange[todo], begun + starts)[:, begun:]
        begun += starts
        poses = np.repeat(base_from_flange[todo], starts, axis=0)
        fitted = fit(
            chain,
            poses,
            seeds[nearest.ravel()],
            lower=limits.lower,
            upper=limits.upper,
            rounds=rounds,
        )
        solutions, inside = _within(chain, limits, fitted.q)
        good = np.logical_and(inside, fitted.total < reached_within(chain)).reshape(len(todo), starts)
        choice = np.argmax(good, axis=1)
        rows = np.arange(len(todo))
        q[todo] = solutions.reshape(len(todo), starts, chain.size)[rows, choice]
        solved[todo] = good[rows, choice]
    return q, solved


def _next_to_meant(
    chain: Chain, nominal: Form, limits: Limits, base_from_flange: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Return joint positions of a calibrated arm near its nominal solutions.

    Args:
        chain: the calibrated arm.
        nominal: the closed form of its nominal arm.
        limits: its limits.
        base_from_flange: (N, 4, 4).

    Returns:
        q (N, 6) [rad], and a mask (N,) of the entries that reach their poses within limits.
    """
    low, high = span(chain, limits)
    found = closed_form(nominal, base_from_flange, 0.5 * (low + high)[:, None])
    q, inside = _within(chain, limits, found.q.transpose(2, 1, 0))
    # prefer the branch farthest from all limits, since the solution is only near the nominal one
    room = np.minimum(q - limits.lower, limits.upper - q).min(axis=2)
    choice = np.argmax(np.where(found.valid.T & inside, room, -1.0), axis=1)
    exact, miss = polished(chain, base_from_flange, q[np.arange(len(q)), choice])
    exact, inside = _within(chain, limits, exact)
    return exact, inside & (miss < reached_within(chain))


def _within(chain: Chain, limits: Limits, q: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return `q` (..., n) shifted to the full turns nearest to the middle of the limits, and a mask (...) of
    the positions within limits.
    """
    low, high = span(chain, limits)
    lifted = nearest_turn(chain, limits, q, 0.5 * (low + high))
    inside: NDArray[np.bool_] = np.abs(beyond(limits, lifted)).max(axis=-1) <= EDGE
    return np.clip(lifted, limits.lower, limits.upper), inside


def span(chain: Chain, limits: Limits) -> tuple[Array, Array]:
    """Return the lower and upper ends of the interval in which each joint is searched, (n,) each [rad or m].

    The interval is the joint's range; for a turning joint, at most a full turn about the middle of the range.
    For a joint without limits, it is half a turn to either side of 0, or the arm's size for a sliding joint.
    """
    half = np.where(chain.is_prismatic, extent(chain), math.pi)
    bounded = np.isfinite(limits.lower) & np.isfinite(limits.upper)
    lower, upper = np.where(bounded, limits.lower, -half), np.where(bounded, limits.upper, half)
    middle = 0.5 * (lower + upper)
    turning = ~chain.is_prismatic
    low: Array = np.where(turning, np.maximum(lower, middle - math.pi), lower)
    high: Array = np.where(turning, np.minimum(upper, middle + math.pi), upper)
    return low, high


def within(chain: Chain, limits: Limits, count: int) -> Array:
    """Return fixed joint positions (count, n) [rad or m] within limits, spread evenly."""
    low, high = span(chain, limits)
    share = restarts(chain, count) / np.where(chain.is_prismatic, extent(chain), math.pi)
    spread: Array = 0.5 * (low + high) + 0.5 * (high - low) * share
    return spread


@lru_cache(maxsize=16)
def _start_positions(chain: Chain, limits: Limits) -> Array:
    """Return the fixed joint positions (STARTS, n) from which searches start, cached by the identity of chain
    and limits.
    """
    return within(chain, limits, STARTS)


@lru_cache(maxsize=16)
def _start_features(chain: Chain, limits: Limits) -> Array:
    return _features(chain, flange_poses(chain, _start_positions(chain, limits)))


def _features(chain: Chain, poses: Array) -> Array:
    """Map poses (N, 4, 4) to points (N, 12) whose distances grow with the translation and the turn between
    the poses.
    """
    points: Array = np.empty((len(poses), 12))
    points[:, :3] = poses[:, :3, 3] / arm_length(chain, np.eye(4))
    points[:, 3:] = poses[:, :3, :3].reshape(-1, 9) * (TURNED / math.sqrt(2.0))
    return points


def _nearest_starts(chain: Chain, limits: Limits, poses: Array, most: int) -> NDArray[np.int_]:
    """Return, for each pose, the indices (N, most) of the starts whose own poses are nearest to it, the
    nearest first.
    """
    features = _start_features(chain, limits)
    half_square = 0.5 * np.square(features).sum(axis=1)
    result = np.empty((len(poses), most), dtype=int)
    for first in range(0, len(poses), BLOCK):
        piece = slice(first, first + BLOCK)
        # half the squared distance, except for a term that is the same for all starts
        away = half_square - _features(chain, poses[piece]) @ features.T
        if most == 1:
            result[piece, 0] = np.argmin(away, axis=1)
            continue
        some = np.argpartition(away, most - 1, axis=1)[:, :most]
        order = np.argsort(np.take_along_axis(away, some, axis=1), axis=1, kind="stable")
        result[piece] = np.take_along_axis(some, order, axis=1)
    return result
