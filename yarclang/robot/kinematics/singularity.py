"""How near joint positions are to a singularity, and what a motion of the tool costs there in joint speed.

A Jacobian mixes m and rad, so that its singular values mean nothing until lengths and angles are
weighted. Here every length is divided by the arm's characteristic length L: the most that the tool can be
away from the first axis (`reach.arm_length`). A way of L counts as much as a turn of 1 rad, of the tool and of a sliding joint alike,
and the smallest singular value is a pure number: 0 at a singularity, 0.1 or so far from one.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import poses_and_jacobians
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.model import Array, Chain

_ROUNDING = 1e-9
"""What squares of singular values, of up to some tens, may lose by rounding, and much more."""


@frozen(eq=False)
class Nearness:
    """How near joint positions are to a singularity.

    `smallest` (N,) is the smallest singular value of the weighted Jacobian. `joints` (N, n) is the motion
    of the joints that moves the tool least, of length 1 [rad, or L for a sliding joint]: its large
    entries name the joints that work against each other. `twist` (N, 6) is the motion of the tool that is hardest
    to make, of length 1: linear part [L] above angular part [rad], axes of {B}.
    """

    smallest: Array
    joints: Array
    twist: Array


def nearness(chain: Chain, q: Array, flange_from_tool: Array) -> Nearness:
    """The smallest singular value at each joint position, and which motions belong to it.

    An arm with fewer than six joints has as many singular values as joints: it's singular where it
    can do less than elsewhere. With more than six the smallest of six counts, and the others of the null space don't.

    Args:
        chain: the arm, n joints.
        q: (N, n) [rad or m].
        flange_from_tool: (4, 4).
    """
    scaled = weighted_jacobians(chain, q, flange_from_tool)
    left, values, right = np.linalg.svd(scaled, full_matrices=False)
    return Nearness(values[:, -1], right[:, -1], left[:, :, -1])


def smallest_singular_values(chain: Chain, q: Array, flange_from_tool: Array) -> Array:
    """As `nearness(...).smallest` (N,), without the motions."""
    scaled = weighted_jacobians(chain, q, flange_from_tool)
    return np.linalg.svd(scaled, compute_uv=False)[:, -1].astype(float)


def are_all_above(chain: Chain, q: Array, flange_from_tool: Array, limit: float) -> bool:
    """Return True if the smallest singular value is proved to be above a limit at every joint position.

    The squares of the singular values, less that of the limit, are all positive if there is a Cholesky factor: a fifth of the time of the values.
    Very near the limit the answer is False.

    Args:
        chain: the arm, n joints.
        q: (N, n) [rad or m].
        flange_from_tool: (4, 4).
        limit: a pure number.
    """
    scaled = weighted_jacobians(chain, q, flange_from_tool)
    turned = scaled.transpose(0, 2, 1)
    squares = scaled @ turned if chain.size >= 6 else turned @ scaled
    squares -= (limit * limit + _ROUNDING) * np.eye(squares.shape[1])
    try:
        np.linalg.cholesky(squares)
    except np.linalg.LinAlgError:
        return False
    return True


def weighted_jacobians(chain: Chain, q: Array, flange_from_tool: Array) -> Array:
    """The geometric Jacobians (N, 6, n) at the tool with all lengths in units of L."""
    length = arm_length(chain, flange_from_tool)
    jacobians = poses_and_jacobians(chain, q, flange_from_tool)[1]
    per_length = np.repeat([1.0 / length, 1.0], 3)
    scaled: Array = jacobians * per_length[:, None] * np.where(chain.is_prismatic, length, 1.0)
    return scaled
