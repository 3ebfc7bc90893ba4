"""How far the moving frame is from the straight line that a LineMove asks for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify.bounds import (
    HERMITE,
    Cubics,
    arm_fourth,
    catch_up,
    fourth,
    hermite_bezier,
    reaches,
    segment_max,
)
from yarclang.certify.certificate import Deviation
from yarclang.certify.pose import angle_of_chord, axis_and_angle, distance
from yarclang.robot.kinematics.fk import poses_and_jacobians, skew
from yarclang.robot.model import Array, Chain, Robot, Tolerance

REMAINDER_SHARE = 0.02
"""Pieces are made so short that the remainder of the proof is at most this share of the tolerance."""
MOST_PIECES = 32
"""... but never more than this many a segment: a motion that needs more is far out of any limit."""


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """The programmed paths of C lines: from the poses `start` (C, 4, 4) to the poses `goal` of the moving
    frames, which sit at `flange_from_moving` (C, 4, 4).
    """

    start: Array
    goal: Array
    flange_from_moving: Array


def goal_pose(goal: hir.PoseGoal | hir.PoseDelta, base_from_flange: Array) -> tuple[Array, Array]:
    """Where a line starts and ends.

    Args:
        goal: the programmed goal.
        base_from_flange: (4, 4) where the flange is when the line starts.

    Returns:
        base_from_moving (4, 4) at the start and at the goal.
    """
    start = base_from_flange @ goal.flange_from_moving
    if isinstance(goal, hir.PoseGoal):
        return start, goal.base_from_moving
    axes = base_from_flange[:3, :3] @ goal.axes if goal.axes_on_flange else goal.axes
    pose = start.copy()
    pose[:3, :3] = axes @ goal.turn @ axes.T @ start[:3, :3]
    pose[:3, 3] = start[:3, 3] + axes @ goal.shift
    return start, pose


def line_deviations(
    cubics: Cubics, first: NDArray[np.int64], lines: Lines, ends: Array, robot: Robot, tolerance: Tolerance
) -> list[Deviation]:
    """Proved bounds of the deviation from straight lines with a turn about one fixed axis.

    For any parameter s(t) that grows from 0 to 1 the distance at equal t bounds the distance between the
    paths. s(t) is the cubic Hermite interpolation, piece by piece, of the projection of the executed
    pose onto the programmed path (position and angle weighted by their tolerances). On a piece,
    e(t) = p(q(t)) - p*(s(t)) is at most its largest Bezier point plus the remainder d^4/384 M4, where the
    line itself adds nothing to M4. For the turn, D = R(q(t)) - R*(s(t)) has the Frobenius norm
    2 sqrt 2 sin(angle/2), and pieces are bounded in that norm; a turn by
    theta s(t) about a fixed axis adds sqrt 2 `fourth` of its derivatives to M4.

    Args:
        cubics: the segments of all C lines.
        first: (C,) the first segment of each.
        lines: the programmed paths.
        ends: (C, 4, 4) where the moving frames end.
        robot: the arm.
        tolerance: what the proof should be sharp against.

    Returns:
        C bounds, each with the distance of the end from the goal.
    """
    count = np.diff(np.append(first, len(cubics.h)))
    command = np.repeat(np.arange(len(first)), count)
    travel = np.abs(np.concatenate(cubics.position_range())).max(axis=0)
    reach = _reaches(robot.chain, lines.flange_from_moving, travel)
    w, a, j = cubics.velocity_peaks(), cubics.acceleration_peaks(), np.abs(cubics.j)
    origin, rotation = np.empty(len(command)), np.empty(len(command))
    for row, commands in reach:
        chosen = np.isin(command, commands)
        bound = arm_fourth(row, robot.chain.is_prismatic, w[chosen], a[chosen], j[chosen])
        origin[chosen], rotation[chosen] = bound.origin, bound.rotation

    scale = HERMITE * cubics.h**4 / REMAINDER_SHARE
    # a difference's norm is about sqrt 2 times the angle, and the programmed turn adds about as much again
    need = scale * np.maximum(origin / tolerance.position, 2.0 * rotation / np.sqrt(2.0) / tolerance.angle)
    pieces = np.clip(np.ceil(need**0.25), 1, MOST_PIECES).astype(np.int64)
    end_position, end_angle = distance(ends, lines.goal)
    bounds = _bounds(cubics, command, pieces, origin, rotation, lines, robot, tolerance)
    return [
        Deviation(
            max(float(position), float(at_end)),
            max(float(angle), float(turn_at_end)),
            float(at_end),
            float(turn_at_end),
            float(rest),
            float(turn_rest),
        )
        for position, angle, rest, turn_rest, at_end, turn_at_end in zip(
            *bounds, end_position, end_angle, strict=True
        )
    ]


def _reaches(chain: Chain, flange_from_moving: Array, travel: Array) -> list[tuple[Array, NDArray[np.int64]]]:
    """The reach (n,) of each moving frame in use, and the commands that move it."""
    frames, group = np.unique(flange_from_moving.reshape(-1, 16), axis=0, return_inverse=True)
    return [
        (reaches(chain, frame.reshape(4, 4), travel), np.nonzero(group.ravel() == i)[0])
        for i, frame in enumerate(frames)
    ]


@dataclass(frozen=True, slots=True, eq=False)
class _Motion:
    """The moving frame at points of time: position p, rotation R, and their time derivatives."""

    p: Array
    velocity: Array
    rotation: Array
    angular: Array


def _bounds(
    cubics: Cubics,
    command: NDArray[np.int64],
    pieces: NDArray[np.int64],
    origin: Array,
    rotation: Array,
    lines: Lines,
    robot: Robot,
    tolerance: Tolerance,
) -> tuple[Array, Array, Array, Array]:
    """Deviations and remainders (C,) each, of position and angle."""
    segment = np.repeat(np.arange(len(pieces)), pieces)
    number = np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    d = (cubics.h / pieces)[segment]
    owner = command[segment]
    begins = np.flatnonzero(np.diff(owner, prepend=-1))
    # the points between pieces: those of one command lie behind each other, one more than its pieces
    left = np.arange(len(segment)) + owner
    last = np.append(begins[1:], len(segment)) + np.arange(len(begins))
    q, rate = (np.empty((len(segment) + len(begins), robot.size)) for _ in range(2))
    q[left], rate[left] = cubics.take(segment).at(number * d)
    closing = np.append(np.flatnonzero(np.diff(command)), len(command) - 1)
    q[last], rate[last] = cubics.take(closing).at(cubics.h[closing])
    point_owner = np.empty(len(q), dtype=np.int64)
    point_owner[left], point_owner[last] = owner, np.arange(len(begins))

    motion = _motion(robot.chain, q, rate, lines.flange_from_moving[point_owner])
    e, e_rate, turn, turn_rate, s, s_rate, length, theta = _errors(motion, lines, point_owner, tolerance)
    right = left + 1
    bezier_s = np.stack(hermite_bezier(s[left], s_rate[left], s[right], s_rate[right], d), axis=1)
    behind = catch_up(bezier_s, owner)
    ds = np.diff(bezier_s, axis=1) * (3.0 / d)[:, None]
    dds = np.diff(ds, axis=1) * (2.0 / d)[:, None]
    ddds = np.abs(np.diff(dds, axis=1)[:, 0]) / d
    path = theta[owner]
    slerp = np.sqrt(2.0) * fourth(np.abs(ds).max(axis=1) * path, np.abs(dds).max(axis=1) * path, ddds * path)

    rest = HERMITE * d**4 * origin[segment]
    position = _hull(e, e_rate, left, right, d) + rest + behind * length[owner]
    chord_rest = HERMITE * d**4 * (rotation[segment] + slerp)
    chord = _hull(turn, turn_rate, left, right, d)
    angle = np.minimum(angle_of_chord(chord + chord_rest) + behind * path, np.pi)
    angle_rest = angle_of_chord(chord + chord_rest) - angle_of_chord(chord)
    position, angle, rest, angle_rest = (segment_max(x, begins) for x in (position, angle, rest, angle_rest))
    return position, angle, rest, angle_rest


def _motion(chain: Chain, q: Array, rate: Array, flange_from_moving: Array) -> _Motion:
    flange, jacobian = poses_and_jacobians(chain, q, np.eye(4))
    twist = (jacobian @ rate[:, :, None])[:, :, 0]
    arm = (flange[:, :3, :3] @ flange_from_moving[:, :3, 3:])[:, :, 0]
    angular = twist[:, 3:]
    return _Motion(
        flange[:, :3, 3] + arm,
        twist[:, :3] + np.cross(angular, arm),
        flange[:, :3, :3] @ flange_from_moving[:, :3, :3],
        angular,
    )


def _errors(
    motion: _Motion, lines: Lines, owner: NDArray[np.int64], tolerance: Tolerance
) -> tuple[Array, Array, Array, Array, Array, Array, Array, Array]:
    """Executed minus programmed, with time derivatives, at the points; s with its derivative; length [m] and
    turn [rad] of each line.
    """
    way = lines.goal[:, :3, 3] - lines.start[:, :3, 3]
    length = np.linalg.norm(way, axis=1)
    start = lines.start[:, :3, :3]
    axis, theta = axis_and_angle(lines.goal[:, :3, :3] @ start.transpose(0, 2, 1))
    # projection by least squares of both errors, each against its tolerance
    pull, twist_pull = way / tolerance.position**2, axis * (theta / tolerance.angle**2)[:, None]
    norm = (length / tolerance.position) ** 2 + (theta / tolerance.angle) ** 2
    norm[norm == 0.0] = np.inf  # it shall stand still: s = 0
    offset = motion.p - lines.start[owner, :3, 3]
    turned = _angle_about(motion.rotation @ start.transpose(0, 2, 1)[owner], axis[owner])
    strength = theta[owner] / tolerance.angle**2
    s = (np.einsum("ni,ni->n", offset, pull[owner]) + turned * strength) / norm[owner]
    s_rate = np.einsum("ni,ni->n", motion.velocity, pull[owner])
    s_rate = (s_rate + np.einsum("ni,ni->n", motion.angular, twist_pull[owner])) / norm[owner]

    e = offset - s[:, None] * way[owner]
    e_rate = motion.velocity - s_rate[:, None] * way[owner]
    # R*(s) = R0 + sin K R0 + (1 - cos) K^2 R0 with K = [axis]x
    spin = skew(axis)
    once = spin @ start
    twice = spin @ once
    phi, phi_rate = s * theta[owner], s_rate * theta[owner]
    sin, cos = np.sin(phi)[:, None, None], np.cos(phi)[:, None, None]
    once, twice = once[owner], twice[owner]
    turn = motion.rotation - start[owner] - sin * once - (1.0 - cos) * twice
    turn_rate = np.cross(motion.angular[:, :, None], motion.rotation, axis=1)
    turn_rate -= phi_rate[:, None, None] * (cos * once + sin * twice)
    return e, e_rate, turn.reshape(-1, 9), turn_rate.reshape(-1, 9), s, s_rate, length, theta


def _angle_about(rotation: Array, axis: Array) -> Array:
    """The turn about `axis` (N, 3) that comes nearest to `rotation` (N, 3, 3) in the Frobenius norm [rad]."""
    along = np.einsum("ni,nij,nj->n", axis, rotation, axis)
    across = np.trace(rotation, axis1=1, axis2=2) - along
    vee = np.stack(
        [
            rotation[:, 2, 1] - rotation[:, 1, 2],
            rotation[:, 0, 2] - rotation[:, 2, 0],
            rotation[:, 1, 0] - rotation[:, 0, 1],
        ],
        axis=1,
    )
    angle: Array = np.arctan2(np.einsum("ni,ni->n", axis, vee), across)
    return angle


def _hull(e: Array, rate: Array, left: NDArray[np.int64], right: NDArray[np.int64], d: Array) -> Array:
    """The largest Bezier point of each piece, of errors e (N, m) and their rates at the points."""
    ends = np.linalg.norm(e, axis=1)
    third = (d / 3.0)[:, None]
    inner = np.linalg.norm(e[left] + third * rate[left], axis=1)
    outer = np.linalg.norm(e[right] - third * rate[right], axis=1)
    hull: Array = np.maximum(np.maximum(ends[left], ends[right]), np.maximum(inner, outer))
    return hull
