"""Forward kinematics of the judge.

Each joint turns about, or slides along, the z axis of its own frame; constant transforms lead from one joint
frame to the next. Samples are the last dimension of arrays, and are computed in blocks.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from yarclang.certify.kinematics.elbow import find_elbow
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain, Lines

_BLOCK = 1024
"""Number of samples that are computed in one step, small enough for the processor's cache."""

_NO_PITCH = 1e-11
"""Largest pitch [m/rad] of a joint that counts as turning only.

For an axis more than 1 m from the origin of {B}, the limit is multiplied by this distance in metres.

No joint of a URDF both turns and slides. Rounding leaves a small pitch, such as 1e-14 m/rad for an arm 100 m
from its URDF's root.
"""


@frozen(eq=False)
class _Steps:
    """Constant transforms of a chain of n joints.

    Attributes:
        lines: the axes.
        hinges: (n, 4, 4) frames of the joints in {B} with all joints at zero, the axis along z.
        back: (n, 4, 4) inverses of `hinges`.
        into: (n, 4, 4) transposed transforms from each joint's frame to the next one. The last one leads to
            the flange.
    """

    lines: Lines
    hinges: Array
    back: Array
    into: Array


@lru_cache(maxsize=256)
def _steps(chain: Chain) -> _Steps:
    """Compute the constant transforms of a chain. Results are cached by the chain's identity."""
    lines = axes_of(chain)
    size = chain.size
    hinges = np.zeros((size, 4, 4))
    for joint, (axis, point) in enumerate(zip(lines.axes, lines.points, strict=True)):
        # The x and y axes may point anywhere across the axis z: project the unit vector that is least aligned
        # with z.
        least = int(np.argmin(np.abs(axis)))
        side = np.eye(3)[least] - axis * axis[least]
        side = side / np.sqrt(side @ side)
        hinges[joint, :3, 0], hinges[joint, :3, 1], hinges[joint, :3, 2] = side, np.cross(axis, side), axis
        hinges[joint, :3, 3], hinges[joint, 3, 3] = point, 1.0
    back = np.zeros_like(hinges)
    back[:, :3, :3] = hinges[:, :3, :3].transpose(0, 2, 1)
    # The inverse of a transform (R, p) is (R', -R' p).
    back[:, :3, 3] = -np.einsum("nij,nj->ni", back[:, :3, :3], hinges[:, :3, 3])
    back[:, 3, 3] = 1.0
    following = np.concatenate([hinges[1:], chain.base_from_flange[None]])
    into = np.ascontiguousarray((back @ following).transpose(0, 2, 1))
    return _Steps(lines, hinges, back, into)


@lru_cache(maxsize=256)
def axes_of(chain: Chain) -> Lines:
    """Return the joint axes of a chain with all joints at zero.

    The axis of a screw (v, w) with w not zero is along w, through w x v / |w|^2.
    """
    size = chain.size
    axes, points, turns, slides = np.zeros((size, 3)), np.zeros((size, 3)), np.zeros(size), np.zeros(size)
    for joint, screw in enumerate(chain.screws):
        along, about = screw[:3], screw[3:]
        # A screw without an angular part is a translation along its linear part.
        rate = float(np.sqrt(about @ about))
        if rate == 0.0:
            slides[joint] = float(np.sqrt(along @ along))
            axes[joint] = along / slides[joint]
            continue
        turns[joint] = rate if abs(rate - 1.0) > 1e-12 else 1.0
        axes[joint] = about / rate
        # Compute the point of the axis nearest to the origin, and the pitch: the part of the screw's linear
        # part along the axis.
        points[joint] = np.cross(about, along) / rate**2
        pitch = float(axes[joint] @ along)
        slides[joint] = pitch if abs(pitch) > _NO_PITCH * max(1.0, float(np.sqrt(along @ along))) else 0.0
    return Lines(axes, points, turns, slides)


def steps_of(chain: Chain) -> tuple[Array, ...]:
    """Return the constant transforms (4, 4) of a chain between the movements of its joints.

    They lead from {B} to the first joint's frame, from each joint's frame to the next, and from the last to
    the flange. Each joint turns about the z axis of its frame, or slides along it.
    """
    steps = _steps(chain)
    return (steps.hinges[0], *(one.T for one in steps.into))


def _hinged(chain: Chain, q: Array) -> tuple[Array, Array]:
    """Compute the joint frames and the flange of a chain at P joint positions.

    Args:
        chain: n joints.
        q: (n, P) joint positions [rad or m].

    Returns:
        The joint frames (n, 4, 3, P), each without the movement of its own joint, and the flange (4, 3, P),
        all in {B}. The four rows of a frame are its three axes and its origin.
    """
    steps = _steps(chain)
    turns, slides = steps.lines.turn, steps.lines.slide
    angle = q * turns[:, None]
    sine, cosine = np.sin(angle), np.cos(angle)
    count = q.shape[1]
    frames = np.empty((chain.size + 1, 4, 3, count))
    frames[0] = steps.hinges[0, :3].T[:, :, None]
    moved = np.empty((4, 3, count))
    for joint in range(chain.size):
        here = frames[joint]
        # Turn the x and y axes about z, or slide along z, then apply the constant transform to the next
        # joint's frame.
        if turns[joint]:
            moved[0] = here[0] * cosine[joint] + here[1] * sine[joint]
            moved[1] = here[1] * cosine[joint] - here[0] * sine[joint]
        else:
            moved[:2] = here[:2]
        moved[2:] = here[2:]
        if slides[joint]:
            moved[3] += here[2] * (slides[joint] * q[joint])
        np.matmul(steps.into[joint], moved.reshape(4, -1), out=frames[joint + 1].reshape(4, -1))
    return frames[:-1], frames[-1]


def flange_poses(chain: Chain, q: Array) -> Array:
    """Return base_from_flange (P, 4, 4) [m] for joint positions (P, n) [rad or m]."""
    poses = np.zeros((len(q), 4, 4))
    poses[:, 3, 3] = 1.0
    for rows in _blocks(len(q)):
        poses[rows, :3] = _hinged(chain, q[rows].T)[1].transpose(2, 1, 0)
    return poses


def tool_poses(chain: Chain, q: Array, flange_from_tool: Array) -> Array:
    """Return base_from_tool (P, 4, 4) [m] at joint positions (P, n), for flange_from_tool (4, 4)."""
    found: Array = flange_poses(chain, q) @ flange_from_tool
    return found


def poses_and_jacobians(chain: Chain, q: Array, flange_from_tool: Array) -> tuple[Array, Array]:
    """Compute the poses of a tool frame and its geometric Jacobians.

    Args:
        chain: n joints.
        q: (P, n) joint positions [rad or m].
        flange_from_tool: (4, 4) tool frame, relative to the flange.

    Returns:
        base_from_tool (P, 4, 4), and the Jacobians (P, 6, n). A column is the velocity of the frame's origin
        [m], followed by its angular velocity [rad], both per unit of the joint's velocity and in the axes of
        {B}.
    """
    lines = _steps(chain).lines
    simple = bool((lines.turn == 1.0).all() and not lines.slide.any())
    poses = np.zeros((len(q), 4, 4))
    poses[:, 3, 3] = 1.0
    jacobians = np.empty((len(q), 6, chain.size))
    tool = flange_from_tool.T
    for rows in _blocks(len(q)):
        frames, flange = _hinged(chain, q[rows].T)
        columns = (tool @ flange.reshape(4, -1)).reshape(flange.shape)
        poses[rows, :3] = columns.transpose(2, 1, 0)
        axes = frames[:, 2]
        # Per unit of its motion, a revolute joint moves the frame's origin by axis x (origin - point on the
        # axis).
        x, y, z = (columns[3] - frames[:, 3]).transpose(1, 0, 2)
        columns_of = np.empty((6, *axes[:, 0].shape))
        columns_of[0] = axes[:, 1] * z - axes[:, 2] * y
        columns_of[1] = axes[:, 2] * x - axes[:, 0] * z
        columns_of[2] = axes[:, 0] * y - axes[:, 1] * x
        columns_of[3:] = axes.transpose(1, 0, 2)
        if not simple:
            columns_of *= lines.turn[:, None]
            columns_of[:3] += lines.slide[:, None] * axes.transpose(1, 0, 2)
        jacobians[rows] = columns_of.transpose(2, 0, 1)
    return poses, jacobians


def motions(chain: Chain, q: Array, rate: Array) -> tuple[Array, Array, Array]:
    """Compute the placements and velocities of the bodies that the first k joints move, for k = 0 to n.

    Args:
        chain: n joints.
        q: (P, n) joint positions [rad or m].
        rate: (P, n) joint velocities [rad/s or m/s].

    Returns:
        Placements as in `Kinematics.placements`, angular velocities (n + 1, 3, P) [rad/s], and velocities (n
        + 1, 3, P) [m/s] of the point, rigidly attached to the bodies, that is at the origin of {B}. All are
        in the axes of {B}.
    """
    placed = KINEMATICS.placements(chain, q)
    lines, count = axes_of(chain), len(q)
    spin, drift = np.zeros((chain.size + 1, 3, count)), np.zeros((chain.size + 1, 3, count))
    for joint in range(chain.size):
        turn, shift = placed[joint, :, :3], placed[joint, :, 3]
        axis = np.tensordot(turn, lines.axes[joint], axes=(1, 0))
        x, y, z = np.tensordot(turn, lines.points[joint], axes=(1, 0)) + shift
        spin[joint + 1] = axis * (lines.turn[joint] * rate[:, joint])
        # A rotation with the angular velocity w about an axis through o gives the body's point at the origin
        # of {B} the velocity o x w.
        u, v, w = spin[joint + 1]
        drift[joint + 1] = np.stack([y * w - z * v, z * u - x * w, x * v - y * u])
        drift[joint + 1] += axis * (lines.slide[joint] * rate[:, joint])
    return placed, np.cumsum(spin, axis=0), np.cumsum(drift, axis=0)


def _blocks(count: int) -> Iterator[slice]:
    for begin in range(0, count, _BLOCK):
        yield slice(begin, min(begin + _BLOCK, count))


class Kinematics:
    """The judge's kinematics, with the interface that the shared code for distances, zones and parts uses."""

    __slots__ = ()

    def placements(self, chain: Chain, q: Array) -> Array:
        """Return the transforms (n + 1, 3, 4, P) in {B} that move each link from its pose with all joints at
        zero to its pose at the joint positions `q` (P, n). Row k is for the link that the first k joints
        move.
        """
        count = len(q)
        frames = _hinged(chain, np.ascontiguousarray(q.T))
        steps = _steps(chain)
        placed = np.empty((chain.size + 1, 3, 4, count))
        placed[0] = np.eye(3, 4)[:, :, None]
        # The pose of frame k + 1 is G_(k+1) times its pose with all joints at zero, and G_(k+1) is wanted.
        followed = [*frames[0][1:], frames[1]]
        backs = [*steps.back[1:], _inverted(chain.base_from_flange)]
        for joint, (frame, back) in enumerate(zip(followed, backs, strict=True)):
            columns = np.matmul(back.T, frame.reshape(4, -1)).reshape(4, 3, count)
            placed[joint + 1] = columns.transpose(1, 0, 2)
        return placed

    def flange(self, chain: Chain, q: Array) -> Array:
        """Return base_from_flange (P, 4, 4) for joint positions `q` (P, n)."""
        return flange_poses(chain, q)

    def lines(self, chain: Chain) -> Lines:
        """Return the axes of a chain."""
        return axes_of(chain)

    def elbow(self, chain: Chain) -> tuple[int, Array] | None:
        """Return the index of the elbow's joint and the elbow's point (3,) [m]; None without an elbow."""
        return find_elbow(axes_of(chain), chain.base_from_flange[:3, 3])


KINEMATICS = Kinematics()


def _inverted(placed: Array) -> Array:
    made = np.eye(4)
    made[:3, :3] = placed[:3, :3].T
    made[:3, 3] = -made[:3, :3] @ placed[:3, 3]
    return made
