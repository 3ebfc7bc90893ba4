"""Division of segments into pieces of time, poses of moving frames between the pieces, and bounds."""

from __future__ import annotations

import numpy as np

from yarclang.certify.kinematics.arm import poses_and_jacobians
from yarclang.certify.motion.bounds import Cubics, arm_fourth, reaches
from yarclang.certify.motion.programmed import Motion, Rows
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Chain, Robot

_AT_ONCE = 8_192
"""Number of points at which frames and Jacobians are computed in one step."""


@frozen(eq=False)
class Pieces:
    """P pieces of segments in order of time, with the N instants ("points") between them.

    Piece k lies between the points `left`[k] and `left`[k] + 1. Each command has one point more than pieces.

    Attributes:
        segment: (P,) segment of each piece.
        d: (P,) duration of each piece [s].
        command: (P,) command of each piece.
        left: (P,) index of the point at which each piece begins.
        owner: (N,) command of each point.
        q: (N, n) joint positions at the points [rad or m].
        rate: (N, n) joint velocities at the points [rad/s or m/s].
    """

    segment: Rows
    d: Array
    command: Rows
    left: Rows
    owner: Rows
    q: Array
    rate: Array

    @staticmethod
    def cut(cubics: Cubics, command: Rows, pieces: Rows) -> Pieces:
        """Cut each segment into pieces of equal duration.

        Args:
            cubics: N segments.
            command: (N,) command of each segment.
            pieces: (N,) number of pieces of each segment.
        """
        segment = np.repeat(np.arange(len(pieces)), pieces)
        number = np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        d = (cubics.h / pieces)[segment]
        of = command[segment]
        begins = np.flatnonzero(np.diff(of, prepend=-1))
        # Each command has one point more than pieces, so its points are shifted by the number of commands
        # before it.
        left = np.arange(len(segment)) + of
        last = np.append(begins[1:], len(segment)) + np.arange(len(begins))
        q, rate = (np.empty((len(segment) + len(begins), cubics.x.shape[1])) for _ in range(2))
        for begin in range(0, len(segment), _AT_ONCE):
            part = slice(begin, begin + _AT_ONCE)
            q[left[part]], rate[left[part]] = cubics.take(segment[part]).at((number * d)[part])
        closing = np.append(np.flatnonzero(np.diff(command)), len(command) - 1)
        q[last], rate[last] = cubics.take(closing).at(cubics.h[closing])
        owner = np.empty(len(q), dtype=np.int64)
        owner[left], owner[last] = of, np.arange(len(begins))
        return Pieces(segment, d, of, left, owner, q, rate)


def frame_motion(chain: Chain, cut: Pieces, flange_from_moving: Array) -> Motion:
    """Compute the poses and velocities of the moving frames at the points between pieces.

    Args:
        chain: the arm.
        cut: the pieces.
        flange_from_moving: (C, 4, 4) moving frame of each command, relative to the flange.
    """
    count = len(cut.q)
    motion = Motion(
        np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 3, 3)), np.empty((count, 3)), cut.d
    )
    for begin in range(0, count, _AT_ONCE):
        part = slice(begin, begin + _AT_ONCE)
        flange, jacobian = poses_and_jacobians(chain, cut.q[part], np.eye(4))
        go_on()
        moving = flange_from_moving[cut.owner[part]]
        twist = (jacobian @ cut.rate[part, :, None])[:, :, 0]
        # The frame is at the end of the lever `arm`, so its origin has the velocity v + omega x arm.
        arm = (flange[:, :3, :3] @ moving[:, :3, 3:])[:, :, 0]
        motion.p[part] = flange[:, :3, 3] + arm
        motion.velocity[part] = twist[:, :3] + np.cross(twist[:, 3:], arm)
        motion.rotation[part] = flange[:, :3, :3] @ moving[:, :3, :3]
        motion.angular[part] = twist[:, 3:]
    return motion


def arm_bounds(cubics: Cubics, command: Rows, flange_from_moving: Array, robot: Robot) -> tuple[Array, Array]:
    """Bound the fourth time derivatives (N,) of the moving frames' origins and rotations, segment by segment.

    Args:
        cubics: N segments.
        command: (N,) command of each segment.
        flange_from_moving: (C, 4, 4) moving frame of each command, relative to the flange.
        robot: the arm.
    """
    size = robot.chain.size
    low, high = cubics.position_range()
    # Compute the travel of each command separately: a proof must not depend on the text's other commands.
    begins = np.flatnonzero(np.diff(command, prepend=-1))
    travel = np.zeros((len(flange_from_moving), size))
    farthest = np.maximum.reduceat(np.maximum(np.abs(low), np.abs(high)), begins)
    np.maximum.at(travel, command[begins], farthest * robot.chain.is_prismatic)
    w, a, j = cubics.velocity_peaks(), cubics.acceleration_peaks(), cubics.jerk_peaks()
    origin, rotation = np.empty(len(command)), np.empty(len(command))
    # The levers depend only on the moving frame and the travel of the prismatic joints: compute them once for
    # equal values.
    reached = np.concatenate([travel, flange_from_moving.reshape(-1, 16)], axis=1)
    kinds, group = np.unique(reached, axis=0, return_inverse=True)
    kind_of = group.ravel()[command]
    for i, kind in enumerate(kinds):
        chosen = kind_of == i
        reach = reaches(robot.chain, kind[size:].reshape(4, 4), kind[:size])
        bound = arm_fourth(reach, robot.chain.is_prismatic, w[chosen], a[chosen], j[chosen])
        origin[chosen], rotation[chosen] = bound.origin, bound.rotation
    return origin, rotation


def hull(e: Array, rate: Array, left: Rows, right: Rows, d: Array) -> Array:
    """Return the largest norm (P,) of the Bezier points of the error's Hermite cubic on each piece.

    Args:
        e: (N, m) errors at the points between pieces.
        rate: (N, m) time derivatives of the errors.
        left: (P,) index of the point at which each piece begins.
        right: (P,) index of the point at which each piece ends.
        d: (P,) duration of each piece [s].
    """
    ends = np.linalg.norm(e, axis=1)
    third = (d / 3.0)[:, None]
    # Bezier points of a Hermite cubic: e0, e0 + d/3 e0', e1 - d/3 e1', e1. The cubic lies in their convex
    # hull, and a norm is largest at a corner of the hull.
    inner = np.linalg.norm(e[left] + third * rate[left], axis=1)
    outer = np.linalg.norm(e[right] - third * rate[right], axis=1)
    largest: Array = np.maximum(np.maximum(ends[left], ends[right]), np.maximum(inner, outer))
    return largest
