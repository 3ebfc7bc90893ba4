"""The self-motion of arms with more joints than a pose needs: joint positions that all reach it."""

from __future__ import annotations

import numpy as np

from yarclang.progress import go_on
from yarclang.robot.kinematics.elimination import misses_of
from yarclang.robot.kinematics.fk import walk_with_jacobian
from yarclang.robot.kinematics.inverse import extent, reached_within
from yarclang.robot.kinematics.numeric import fit
from yarclang.robot.kinematics.within import EDGE, beyond
from yarclang.robot.model import Array, Chain, Limits

STEP = 0.12
"""The largest change of a joint from one joint position to the next [rad, or m by `weights`]."""

ROUNDS = 40
"""Steps to each side at most: more than half a turn of the joint that moves most."""


LEAST = 1e-3
"""What the way of a joint counts that has hardly any range, as a share of that with the largest."""


def weights(chain: Chain, limits: Limits) -> Array:
    """Return what each joint's way counts against the others (n,) [rad or m]: half of its range, of a turn half a turn at most, of a slide the arm's size."""
    half = 0.5 * (limits.upper - limits.lower)
    ways = np.minimum(half, np.where(chain.is_prismatic, extent(chain), np.pi))
    # a joint that limits lock counts as one that hardly moves
    result: Array = np.maximum(ways, LEAST * ways.max())
    return result


def self_motion(chain: Chain, limits: Limits, base_from_flange: Array, q: Array) -> Array:
    """Return joint positions (m, n) [rad or m] within limits that reach a pose as others do, sampled along the motions of the arm that leave the flange at rest.

    From each position given, steps go to both sides along each direction of the null space, as far as limits allow.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        base_from_flange: (4, 4).
        q: (k, n) [rad or m], joint positions that reach the pose within limits.
    """
    spare = chain.size - 6
    if spare < 1 or not len(q):
        return np.empty((0, chain.size))
    scale = weights(chain, limits) / np.pi
    here = np.repeat(q, 2 * spare, axis=0)
    spaces = null_spaces(chain, q, scale)
    way = np.concatenate((spaces, -spaces), axis=1).reshape(-1, chain.size)
    found = []
    for _ in range(ROUNDS):
        go_on()
        step = way * (STEP / np.maximum(np.abs(way).max(axis=1), 1e-9))[:, None] * scale
        poses = np.broadcast_to(base_from_flange, (len(here), 4, 4))
        moved = fit(chain, poses, here + step, lower=limits.lower, upper=limits.upper, rounds=10)
        # a joint at its limit is held there by the others; what gets nowhere any more has come to an end
        gone = np.abs((moved.q - here) / scale).max(axis=1)
        going = (moved.total < reached_within(chain)) & (gone > 0.25 * STEP) & (gone < 3.0 * STEP)
        going &= np.abs(beyond(limits, moved.q)).max(axis=1) <= EDGE
        if not going.any():
            break
        here, way = moved.q[going], way[going]
        found.append(here)
        # on in the same direction
        null = null_spaces(chain, here, scale)
        way = np.einsum("nki,nk->ni", null, np.einsum("nki,ni->nk", null, way))
    return np.concatenate(found) if found else np.empty((0, chain.size))


def null_spaces(chain: Chain, q: Array, scale: Array) -> Array:
    """Return the directions (m, k, n), orthonormal, in which joint positions (m, n) leave the flange at rest, each joint's way counted in units of `scale` (n,) [rad or m]."""
    directions: Array = np.linalg.svd(_scaled_jacobians(chain, q, scale))[2][:, 6:]
    return directions


def reaches(chain: Chain, base_from_flange: Array, q: Array) -> bool:
    """Return True if a joint position (n,) reaches a pose (4, 4)."""
    return bool(misses_of(chain, base_from_flange[None], q[None])[0] < reached_within(chain))


def _scaled_jacobians(chain: Chain, q: Array, scale: Array) -> Array:
    jacobians: Array = walk_with_jacobian(chain, np.ascontiguousarray(q.T), np.eye(4))[1].transpose(2, 0, 1)
    return jacobians * scale
