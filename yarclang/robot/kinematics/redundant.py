"""Sample the self-motion of redundant arms: joint positions that all reach the same pose."""

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
"""The largest change of a joint from one sample of the self-motion to the next [units of `weights` / pi: 1
rad for a turning joint without limits].
"""

ROUNDS = 40
"""The largest number of steps to each side of a given joint position. The steps of one side are together
longer than half a turn of the joint that moves most.
"""


LEAST = 1e-3
"""Least weight of a joint that has hardly any range, relative to the largest weight."""


def weights(chain: Chain, limits: Limits) -> Array:
    """Return the unit in which the motion of each joint is counted (n,) [rad or m].

    The unit is half of the joint's range, but at most half a turn for a turning joint, or the arm's size for
    a sliding joint.
    """
    half = 0.5 * (limits.upper - limits.lower)
    ways = np.minimum(half, np.where(chain.is_prismatic, extent(chain), np.pi))
    # a joint whose limits are equal gets a small weight, so that it hardly moves
    result: Array = np.maximum(ways, LEAST * ways.max())
    return result


def self_motion(chain: Chain, limits: Limits, base_from_flange: Array, q: Array) -> Array:
    """Return samples of joint positions within limits that all reach the same pose. They are connected by
    self-motion: joint motion that leaves the flange at rest.

    Starting from each given position, steps are made in both senses of each direction of the null space, up
    to the limits.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        base_from_flange: (4, 4).
        q: (k, n) [rad or m], joint positions that reach the pose within limits.

    Returns:
        (m, n) [rad or m], without the given positions.
    """
    spare = chain.size - 6
    if spare < 1 or not len(q):
        return np.empty((0, chain.size))
    scale = weights(chain, limits) / np.pi
    positions = np.repeat(q, 2 * spare, axis=0)
    spaces = null_spaces(chain, q, scale)
    way = np.concatenate((spaces, -spaces), axis=1).reshape(-1, chain.size)
    samples = []
    for _ in range(ROUNDS):
        go_on()
        step = way * (STEP / np.maximum(np.abs(way).max(axis=1), 1e-9))[:, None] * scale
        poses = np.broadcast_to(base_from_flange, (len(positions), 4, 4))
        moved = fit(chain, poses, positions + step, lower=limits.lower, upper=limits.upper, rounds=10)
        # the fit keeps a joint at its limit. A joint position that then hardly moves isn't continued
        gone = np.abs((moved.q - positions) / scale).max(axis=1)
        going = (moved.total < reached_within(chain)) & (gone > 0.25 * STEP) & (gone < 3.0 * STEP)
        going &= np.abs(beyond(limits, moved.q)).max(axis=1) <= EDGE
        if not going.any():
            break
        positions, way = moved.q[going], way[going]
        samples.append(positions)
        # continue in the same direction: project it onto the new null space
        null = null_spaces(chain, positions, scale)
        way = np.einsum("nki,nk->ni", null, np.einsum("nki,ni->nk", null, way))
    return np.concatenate(samples) if samples else np.empty((0, chain.size))


def null_spaces(chain: Chain, q: Array, scale: Array) -> Array:
    """Return orthonormal directions of joint motion (m, k, n) that leave the flange at rest at joint
    positions (m, n): k directions for each.

    Joint motions are counted in units of `scale` (n,) [rad or m].
    """
    # the right singular vectors after the six singular values span the null space
    directions: Array = np.linalg.svd(_scaled_jacobians(chain, q, scale))[2][:, 6:]
    return directions


def reaches(chain: Chain, base_from_flange: Array, q: Array) -> bool:
    """Return True if a joint position (n,) reaches a pose (4, 4)."""
    return bool(misses_of(chain, base_from_flange[None], q[None])[0] < reached_within(chain))


def _scaled_jacobians(chain: Chain, q: Array, scale: Array) -> Array:
    jacobians: Array = walk_with_jacobian(chain, np.ascontiguousarray(q.T), np.eye(4))[1].transpose(2, 0, 1)
    return jacobians * scale
