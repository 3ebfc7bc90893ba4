"""Measure the distance of joint positions from a singularity, and find the tool motions that need large joint
motions near it.

A Jacobian mixes m and rad, so its singular values are meaningless until lengths and angles are weighted. Here
every length is divided by the arm's characteristic length L, the largest distance of the tool from the first
axis (`reach.arm_length`). A translation by L counts like a turn of 1 rad, for the tool and for a sliding
joint alike. The smallest singular value is then a pure number: 0 at a singularity, about 0.1 far from one.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import poses_and_jacobians
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.model import Array, Chain

_ROUNDING = 1e-9
"""Margin for the rounding of squared singular values. It is many times larger than this rounding, since the
squares are at most some tens.
"""


@frozen(eq=False)
class Nearness:
    """The distance of joint positions from a singularity.

    Attributes:
        smallest: (N,) smallest singular value of the weighted Jacobian.
        joints: (N, n) joint motion of length 1 that moves the tool least [rad, or L for a sliding joint]. Its
            large entries belong to the joints that cancel each other's motion.
        twist: (N, 6) tool motion of length 1 that needs the largest joint motion: linear part [L] above
            angular part [rad], in the axes of {B}.
    """

    smallest: Array
    joints: Array
    twist: Array


def nearness(chain: Chain, q: Array, flange_from_tool: Array) -> Nearness:
    """Compute the smallest singular value of the weighted Jacobian at each joint position, and the joint
    motion and tool motion that belong to it.

    An arm with fewer than six joints has as many singular values as joints: it is singular where it can move
    in fewer directions than elsewhere. An arm with more than six joints has six singular values; its null
    space doesn't count.

    Args:
        chain: the arm, n joints.
        q: (N, n) [rad or m].
        flange_from_tool: (4, 4).
    """
    scaled = weighted_jacobians(chain, q, flange_from_tool)
    left, values, right = np.linalg.svd(scaled, full_matrices=False)
    return Nearness(values[:, -1], right[:, -1], left[:, :, -1])


def smallest_singular_values(chain: Chain, q: Array, flange_from_tool: Array) -> Array:
    """Return `nearness(...).smallest` (N,) without computing the motions."""
    scaled = weighted_jacobians(chain, q, flange_from_tool)
    return np.linalg.svd(scaled, compute_uv=False)[:, -1].astype(float)


def are_all_above(chain: Chain, q: Array, flange_from_tool: Array, limit: float) -> bool:
    """Return True if the smallest singular value is proved to be above a limit at every joint position.

    JJᵀ - limit² I is positive definite exactly if it has a Cholesky factor. Computing this factor takes a
    fifth of the time that the singular values take. If a value is above the limit by no more than rounding,
    the result is False.

    Args:
        chain: the arm, n joints.
        q: (N, n) [rad or m].
        flange_from_tool: (4, 4).
        limit: a pure number.
    """
    scaled = weighted_jacobians(chain, q, flange_from_tool)
    turned = scaled.transpose(0, 2, 1)
    # the smaller of JJᵀ and JᵀJ: its eigenvalues are the squared singular values that count
    squares = scaled @ turned if chain.size >= 6 else turned @ scaled
    squares -= (limit * limit + _ROUNDING) * np.eye(squares.shape[1])
    try:
        np.linalg.cholesky(squares)
    except np.linalg.LinAlgError:
        return False
    return True


def weighted_jacobians(chain: Chain, q: Array, flange_from_tool: Array) -> Array:
    """Return the geometric Jacobians (N, 6, n) at the tool, with all lengths in units of L."""
    length = arm_length(chain, flange_from_tool)
    jacobians = poses_and_jacobians(chain, q, flange_from_tool)[1]
    per_length = np.repeat([1.0 / length, 1.0], 3)
    scaled: Array = jacobians * per_length[:, None] * np.where(chain.is_prismatic, length, 1.0)
    return scaled
