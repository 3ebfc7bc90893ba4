"""Forward kinematics and Jacobians of whole batches (product of exponentials; Lynch and Park, ch. 4 and 5).

Pinocchio reads the URDF; for many poses at once these arrays are several times as fast as a
loop over its calls, and the tests hold them against it.

Inside, each joint gets a frame whose z is the joint's axis, so that its motion is a turn of two
columns, and all that lies between two joints is one constant matrix. The samples are the last
index: a step is a few operations on whole rows, in blocks that stay in the cache.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain, Lines

BLOCK = 1024
"""Samples in one block: the arrays of a step stay in the second-level cache."""
NO_PITCH = 1e-11
"""Joint that slides by less [m] per rad only turns; if its axis is farther than 1 m from {B}'s origin, by this share of the distance. No joint of a URDF does both: what is
left is rounding, about 1e-14 m of an arm 100 m from its URDF's root, and an arm that slides has no closed form."""


def skew(vectors: Array) -> Array:
    """The cross product matrices (..., 3, 3) of `vectors` (..., 3)."""
    matrix = np.zeros((*vectors.shape[:-1], 3, 3))
    matrix[..., 0, 1], matrix[..., 0, 2] = -vectors[..., 2], vectors[..., 1]
    matrix[..., 1, 0], matrix[..., 1, 2] = vectors[..., 2], -vectors[..., 0]
    matrix[..., 2, 0], matrix[..., 2, 1] = -vectors[..., 1], vectors[..., 0]
    return matrix


def joint_transform(screw: Array, q: Array) -> tuple[Array, Array]:
    """The motion of one joint.

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
    # exp([w]q) integrates to I q + (1 - cos q) w + (q - sin q) w^2
    shift = q[:, None] * linear + versine[:, None] * (w @ linear) + (q - sin)[:, None] * (w @ w @ linear)
    return rotation, shift


def flange_poses(chain: Chain, q: Array) -> Array:
    """Where the flange stands: base_from_flange (N, 4, 4) for joint positions `q` (N, n) [rad or m]."""
    return tool_poses(chain, q, np.eye(4))


def tool_poses(chain: Chain, q: Array, flange_from_tool: Array) -> Array:
    """Where a frame on the flange stands: base_from_tool (N, 4, 4) for `q` (N, n) [rad or m]."""
    poses = np.empty((len(q), 4, 4))
    poses[:, 3] = 0.0, 0.0, 0.0, 1.0
    for block in _blocks(len(q)):
        columns = walk(chain, q[block].T, flange_from_tool)[0]
        poses[block, :3] = columns.transpose(2, 1, 0)
    return poses


def poses_and_jacobians(chain: Chain, q: Array, flange_from_tool: Array) -> tuple[Array, Array]:
    """Poses of a frame on the flange and the geometric Jacobians at its origin.

    Args:
        chain: the arm, n joints.
        q: (N, n) [rad or m].
        flange_from_tool: (4, 4).

    Returns:
        base_from_tool (N, 4, 4) and Jacobians (N, 6, n): velocity of the tool's origin [m/s] above
        angular velocity [rad/s], both in the axes of {B}, per unit of joint velocity.
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
    """As `poses_and_jacobians`, with the samples last: `q` (n, N), columns (4, 3, N), Jacobians (6, n, N)."""
    links = links_of(chain)
    columns, axes, origins = walk(chain, q, flange_from_tool)
    arms = columns[3] - origins
    jacobian = np.empty((6, chain.size, q.shape[1]))
    for row in range(3):
        after, before = (row + 1) % 3, (row + 2) % 3
        np.multiply(axes[:, after], arms[:, before], out=jacobian[row])
        jacobian[row] -= axes[:, before] * arms[:, after]
        jacobian[3 + row] = axes[:, row]
    if links.uniform:
        return columns, jacobian
    jacobian *= links.turn[:, None]
    jacobian[:3] += links.slide[:, None] * axes.transpose(1, 0, 2)
    return columns, jacobian


def walk(chain: Chain, q: Array, flange_from_tool: Array) -> tuple[Array, Array, Array]:
    """Step from joint to joint, with the samples last.

    Args:
        chain: the arm, n joints.
        q: (n, N) [rad or m].
        flange_from_tool: (4, 4).

    Returns:
        The tool's axes and, as the fourth, its origin (4, 3, N); each joint's axis (n, 3, N) and
        a point on it (n, 3, N); all in {B}.
    """
    links = links_of(chain)
    count = q.shape[1]
    turns = q if links.uniform else q * links.turn[:, None]
    sin, cos = np.sin(turns), np.cos(turns)
    frames = np.empty((chain.size, 4, 3, count))
    frame = np.empty((4, 3, count))
    frame[:] = links.first[:, :, None]
    for joint in range(chain.size):
        here = frames[joint]
        if joint:
            np.matmul(links.steps[joint], frame.reshape(4, -1), out=here.reshape(4, -1))
        else:
            here[:] = frame
        if links.turn[joint]:
            np.multiply(here[:2], cos[joint], out=frame[:2])
            frame[0] += here[1] * sin[joint]
            frame[1] -= here[0] * sin[joint]
        else:
            frame[:2] = here[:2]
        frame[2:] = here[2:]
        if links.slide[joint]:
            frame[3] += here[2] * (links.slide[joint] * q[joint])
    last = (links.last @ flange_from_tool).T
    columns = (last @ frame.reshape(4, -1)).reshape(4, 3, count)
    return columns, frames[:, 2], frames[:, 3]


@frozen(eq=False)
class Links:
    """The constants of a chain for `walk`.

    `frames` (n, 4, 4) are the joints' frames in {B} with all joints at zero, z along the axis. `first`
    (4, 3) has the columns of the first, `steps` (n, 4, 4) the transposed transforms from each joint's
    frame to the one before, `last` (4, 4) is the flange in the last joint's frame. `turn` (n,) is the
    angle about z, `slide` (n,) the way along z, per unit of joint position; `uniform` says that all
    joints turn by one and none slides.
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
    """The constants of `chain`, remembered by its identity (a chain never changes)."""
    linear, angular = chain.screws[:, :3], chain.screws[:, 3:]
    turn = np.linalg.norm(angular, axis=1)
    turn[np.abs(turn - 1.0) < 1e-12] = 1.0
    prismatic = turn == 0.0
    scale = np.where(prismatic, np.linalg.norm(linear, axis=1), turn)
    axes = np.where(prismatic[:, None], linear, angular) / scale[:, None]
    slide = np.where(prismatic, scale, np.einsum("ni,ni->n", axes, linear))
    # rounding, of an arm that stands far from the origin of {B} or of its URDF: see NO_PITCH
    slide[np.abs(slide) < NO_PITCH * np.maximum(1.0, np.linalg.norm(linear, axis=1))] = 0.0
    frames = np.zeros((chain.size, 4, 4))
    frames[:, :3, 2] = axes
    # the coordinate axis that is farthest from z gives a safe x
    helper = np.eye(3)[np.argmin(np.abs(axes), axis=1)]
    x = np.cross(helper, axes)
    x /= np.linalg.norm(x, axis=1)[:, None]
    frames[:, :3, 0], frames[:, :3, 1] = x, np.cross(axes, x)
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
    """Return the axes of a chain, by the kinematics that the chain brings along, or else by ours."""
    if chain.kinematics is not None:
        return chain.kinematics.lines(chain)
    links = links_of(chain)
    return Lines(links.frames[:, :3, 2], links.frames[:, :3, 3], links.turn, links.slide)


def _blocks(count: int) -> list[slice]:
    """The samples in blocks."""
    return [slice(start, min(start + BLOCK, count)) for start in range(0, count, BLOCK)]
