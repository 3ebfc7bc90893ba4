"""Compute forward kinematics and Jacobians for many joint positions at once (product of exponentials; Lynch
and Park, ch. 4 and 5).

Pinocchio reads the URDF. For many poses at once, the array operations here are several times as fast as a
loop over Pinocchio's functions; the tests compare the results of both.

Internally each joint gets a frame whose z is the joint's axis. The joint's motion then is a rotation of two
columns, and the transform between two joints is one constant matrix. The last index of an array counts the
samples (joint positions). Each step from joint to joint is therefore a few operations on whole rows. The
samples are divided into blocks that stay in the cache.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain, Lines

BLOCK = 1024
"""Number of samples in one block. It is small enough for the arrays of a step to stay in the second-level
cache.
"""
NO_PITCH = 1e-11
"""Largest pitch [m per rad] that is treated as rounding: the joint only turns. If the joint's axis is farther
than 1 m from {B}'s origin, the limit grows in proportion to the distance.

No joint of a URDF both turns and slides. Rounding leaves a pitch of about 1e-14 m for an arm 100 m from its
URDF's root. If this counted as sliding, the arm would have no closed form.
"""


def skew(vectors: Array) -> Array:
    """Return the cross product matrices (..., 3, 3) of `vectors` (..., 3)."""
    matrix = np.zeros((*vectors.shape[:-1], 3, 3))
    matrix[..., 0, 1], matrix[..., 0, 2] = -vectors[..., 2], vectors[..., 1]
    matrix[..., 1, 0], matrix[..., 1, 2] = vectors[..., 2], -vectors[..., 0]
    matrix[..., 2, 0], matrix[..., 2, 1] = -vectors[..., 1], vectors[..., 0]
    return matrix


def joint_transform(screw: Array, q: Array) -> tuple[Array, Array]:
    """Compute the motion of one joint.

    Args:
        screw: (6,), linear part then angular part, in the axes of {B}.
        q: (N,) joint positions [rad or m].

    Returns:
        Rotations (N, 3, 3) and translations (N, 3) of exp(screw q).
    """
    linear, angular = screw[:3], screw[3:]
    if not angular.any():
        return np.broadcast_to(np.eye(3), (len(q), 3, 3)), q[:, None] * linear
    w = skew(angular)
    sin, versine = np.sin(q), 1.0 - np.cos(q)
    rotation = np.eye(3) + sin[:, None, None] * w + versine[:, None, None] * (w @ w)
    # the integral of exp([w]q) is I q + (1 - cos q) w + (q - sin q) w² (Lynch and Park, eq. 3.88)
    shift = q[:, None] * linear + versine[:, None] * (w @ linear) + (q - sin)[:, None] * (w @ w @ linear)
    return rotation, shift


def flange_poses(chain: Chain, q: Array) -> Array:
    """Return the flange's poses base_from_flange (N, 4, 4) at joint positions `q` (N, n) [rad or m]."""
    return tool_poses(chain, q, np.eye(4))


def tool_poses(chain: Chain, q: Array, flange_from_tool: Array) -> Array:
    """Return the poses base_from_tool (N, 4, 4) of a frame fixed to the flange, at joint positions `q` (N, n)
    [rad or m].
    """
    poses = np.empty((len(q), 4, 4))
    poses[:, 3] = 0.0, 0.0, 0.0, 1.0
    for block in _blocks(len(q)):
        columns = walk(chain, q[block].T, flange_from_tool)[0]
        poses[block, :3] = columns.transpose(2, 1, 0)
    return poses


def poses_and_jacobians(chain: Chain, q: Array, flange_from_tool: Array) -> tuple[Array, Array]:
    """Compute the poses of a frame fixed to the flange, and the geometric Jacobians at its origin.

    Args:
        chain: the arm, n joints.
        q: (N, n) [rad or m].
        flange_from_tool: (4, 4).

    Returns:
        base_from_tool (N, 4, 4) and Jacobians (N, 6, n): velocity of the tool's origin [m/s] above angular
        velocity [rad/s], both in the axes of {B}, per unit of joint velocity.
    """
    poses = np.empty((len(q), 4, 4))
    poses[:, 3] = 0.0, 0.0, 0.0, 1.0
    jacobians = np.empty((len(q), 6, chain.size))
    for block in _blocks(len(q)):
        columns, jacobian = walk_with_jacobian(chain, q[block].T, flange_from_tool)
        poses[block, :3] = columns.transpose(2, 1, 0)
        jacobians[block] = jacobian.transpose(2, 0, 1)
    return poses, jacobians


def walk_with_jacobian(chain: Chain, q: Array, flange_from_tool: Array) -> tuple[Array, Array]:
    """Compute poses and Jacobians as `poses_and_jacobians` does, but with the samples as the last index.

    Args:
        chain: the arm, n joints.
        q: (n, N) [rad or m].
        flange_from_tool: (4, 4).

    Returns:
        The tool's columns (4, 3, N) as `walk` returns them, and Jacobians (6, n, N).
    """
    links = links_of(chain)
    columns, axes, origins = walk(chain, q, flange_from_tool)
    # for a turning joint (Lynch and Park, ch. 5.1): angular part z, linear part z x (tool - origin)
    arms = columns[3] - origins
    jacobian = np.empty((6, chain.size, q.shape[1]))
    # linear part: the cross product of axis and lever arm
    for row in range(3):
        after, before = (row + 1) % 3, (row + 2) % 3
        np.multiply(axes[:, after], arms[:, before], out=jacobian[row])
        jacobian[row] -= axes[:, before] * arms[:, after]
        jacobian[3 + row] = axes[:, row]
    if links.uniform:
        return columns, jacobian
    # the general case: the joint turns by `turn` and slides by `slide` per unit
    jacobian *= links.turn[:, None]
    jacobian[:3] += links.slide[:, None] * axes.transpose(1, 0, 2)
    return columns, jacobian


def walk(chain: Chain, q: Array, flange_from_tool: Array) -> tuple[Array, Array, Array]:
    """Compute the frame of the tool and the axes of all joints by stepping from joint to joint. The last
    index of each array counts the joint positions.

    Args:
        chain: the arm, n joints.
        q: (n, N) [rad or m].
        flange_from_tool: (4, 4).

    Returns:
        Three arrays in {B}: the tool's frame (4, 3, N), its three axes and then its origin; each joint's axis
            (n, 3, N); and a point on each axis (n, 3, N).
    """
    links = links_of(chain)
    count = q.shape[1]
    turns = q if links.uniform else q * links.turn[:, None]
    sin, cos = np.sin(turns), np.cos(turns)
    frames = np.empty((chain.size, 4, 3, count))
    frame = np.empty((4, 3, count))
    frame[:] = links.first[:, :, None]
    for joint in range(chain.size):
        reached = frames[joint]
        if joint:
            np.matmul(links.steps[joint], frame.reshape(4, -1), out=reached.reshape(4, -1))
        else:
            reached[:] = frame
        if links.turn[joint]:
            # a turn about z combines only the columns x and y: x' = cos · x + sin · y, y' = cos · y - sin · x
            np.multiply(reached[:2], cos[joint], out=frame[:2])
            frame[0] += reached[1] * sin[joint]
            frame[1] -= reached[0] * sin[joint]
        else:
            frame[:2] = reached[:2]
        frame[2:] = reached[2:]
        if links.slide[joint]:
            frame[3] += reached[2] * (links.slide[joint] * q[joint])
    last = (links.last @ flange_from_tool).T
    columns = (last @ frame.reshape(4, -1)).reshape(4, 3, count)
    return columns, frames[:, 2], frames[:, 3]


@frozen(eq=False)
class Links:
    """The constants of a chain that `walk` needs. Each joint's frame has z along the joint's axis.

    Attributes:
        frames: (n, 4, 4) the joints' frames in {B} with all joints at zero.
        first: (4, 3) columns of the first joint's frame.
        steps: (n, 4, 4) transposed transforms from each joint's frame to the previous frame.
        last: (4, 4) the flange in the last joint's frame.
        turn: (n,) angle about z per unit of joint position.
        slide: (n,) distance along z per unit of joint position.
        uniform: True if `turn` is 1 and `slide` is 0 for all joints.
    """

    frames: Array
    first: Array
    steps: Array
    last: Array
    turn: Array
    slide: Array
    uniform: bool


@lru_cache(maxsize=256)
def links_of(chain: Chain) -> Links:
    """Return the constants of `chain` for `walk`, cached by the chain's identity (a chain never changes)."""
    linear, angular = chain.screws[:, :3], chain.screws[:, 3:]
    turn = np.linalg.norm(angular, axis=1)
    turn[np.abs(turn - 1.0) < 1e-12] = 1.0
    prismatic = turn == 0.0
    scale = np.where(prismatic, np.linalg.norm(linear, axis=1), turn)
    axes = np.where(prismatic[:, None], linear, angular) / scale[:, None]
    slide = np.where(prismatic, scale, np.einsum("ni,ni->n", axes, linear))
    # rounding of an arm far from the origin of {B} or of its URDF: see NO_PITCH
    slide[np.abs(slide) < NO_PITCH * np.maximum(1.0, np.linalg.norm(linear, axis=1))] = 0.0
    frames = np.zeros((chain.size, 4, 4))
    frames[:, :3, 2] = axes
    # the coordinate axis that is farthest from z gives a well-conditioned x
    helper = np.eye(3)[np.argmin(np.abs(axes), axis=1)]
    x = np.cross(helper, axes)
    x /= np.linalg.norm(x, axis=1)[:, None]
    frames[:, :3, 0], frames[:, :3, 1] = x, np.cross(axes, x)
    # the point of the axis nearest to the origin: for a screw (v, w) with |w| = 1, w x v
    frames[:, :3, 3] = np.where(prismatic[:, None], 0.0, np.cross(axes, linear / scale[:, None]))
    frames[:, 3, 3] = 1.0
    inverses = np.linalg.inv(frames)
    steps = np.zeros_like(frames)
    steps[1:] = (inverses[:-1] @ frames[1:]).transpose(0, 2, 1)
    return Links(
        frames=frames,
        first=frames[0, :3].T.copy(),
        steps=steps,
        last=inverses[-1] @ chain.base_from_flange,
        turn=turn,
        slide=slide,
        uniform=bool(np.all(turn == 1.0) and not slide.any()),
    )


def lines_of(chain: Chain) -> Lines:
    """Return the joint axes of a chain: from the chain's own kinematics if it has one, otherwise from this
    module.
    """
    if chain.kinematics is not None:
        return chain.kinematics.lines(chain)
    links = links_of(chain)
    return Lines(links.frames[:, :3, 2], links.frames[:, :3, 3], links.turn, links.slide)


def _blocks(count: int) -> list[slice]:
    """Return the blocks into which the samples are divided."""
    return [slice(start, min(start + BLOCK, count)) for start in range(0, count, BLOCK)]
