"""A straight line of the moving frame, turning about one fixed axis in step with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from yarclang.hir import Array
from yarclang.robot.kinematics.fk import skew, tool_poses
from yarclang.robot.kinematics.inverse import follow
from yarclang.robot.kinematics.track import Broken, Track, track
from yarclang.robot.model import Chain, Limits, Tolerance

NO_TURN = 1e-9
"""A turn smaller than this [rad] has no axis, and needs none."""

_LIKE = Tolerance()
"""What distance counts as much as what angle where a pose is late or early along a line."""


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """Poses of the moving frame over s: from `base_from_start` (4, 4) by `shift` (3,) [m], and by
    `angle` [rad] about the unit vector `axis` (3,), both in the axes of {B}.
    """

    base_from_start: Array
    shift: Array
    axis: Array
    angle: float

    @property
    def length(self) -> float:
        """The length of the line [m]."""
        return float(np.linalg.norm(self.shift))

    @property
    def is_point(self) -> bool:
        """Whether nothing moves."""
        return self.length < 1e-12 and self.angle < NO_TURN

    def poses(self, s: Array) -> Array:
        """base_from_moving (N, 4, 4) at `s` (N,)."""
        turn = skew(self.axis)
        angle = (s * self.angle)[:, None, None]
        poses = np.zeros((len(s), 4, 4))
        rotation = np.eye(3) + np.sin(angle) * turn + (1.0 - np.cos(angle)) * (turn @ turn)
        poses[:, :3, :3] = rotation @ self.base_from_start[:3, :3]
        poses[:, :3, 3] = self.base_from_start[:3, 3] + s[:, None] * self.shift
        poses[:, 3, 3] = 1.0
        return poses


def line_between(base_from_start: Array, base_from_end: Array) -> Line | None:
    """The line between two poses (4, 4), the short way; None for half a turn, which has none."""
    turn = base_from_end[:3, :3] @ base_from_start[:3, :3].T
    # sine times the axis, and the cosine: well conditioned together for every angle
    sine = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2.0
    cosine = (np.trace(turn) - 1.0) / 2.0
    size = float(np.linalg.norm(sine))
    angle = float(np.arctan2(size, cosine))
    if angle > np.pi - 1e-6:
        return None
    axis = sine / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
    shift = base_from_end[:3, 3] - base_from_start[:3, 3]
    return Line(base_from_start, shift, axis, angle if angle > NO_TURN else 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class LinePath:
    """The line as the arm goes along it, in one configuration.

    `followed` follows the arm along the line without a jump; every further position is the
    inverse kinematics nearest to it. `start` is where the robot stands, (n,) [rad or m].
    """

    chain: Chain
    flange_from_moving: Array
    line: Line
    start: Array
    followed: Track

    @property
    def end(self) -> Array:
        """Where the robot stands at s = 1."""
        end: Array = self.followed.q[-1]
        return end

    @property
    def slope(self) -> Array:
        """The steepest slope of each joint over s, about (n,) [rad or m]."""
        track = self.followed
        slope: Array = (np.abs(np.diff(track.q, axis=0)) / np.diff(track.s)[:, None]).max(axis=0)
        return slope

    @property
    def is_straight_in_joints(self) -> bool:
        """Never assumed."""
        return False

    def joints(self, s: Array) -> Array:
        """Joint positions (N, n) at `s` (N,)."""
        poses = _flange(self.line, self.flange_from_moving)(s)
        return follow(self.chain, poses, self.followed.at(s))[0]

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Largest distance of the moving frame from the line [m] and angle from the turn that belongs there [rad].

        What is only early or late along the line doesn't count: the miss, position and turn together, is
        taken across the line's tangent.
        """
        poses = tool_poses(self.chain, q, self.flange_from_moving)
        wanted = self.line.poses(s)
        spin = np.einsum("nij,nkj->nik", poses[:, :3, :3], wanted[:, :3, :3])
        turn = (spin - spin.transpose(0, 2, 1))[:, (2, 0, 1), (1, 2, 0)] / 2.0
        miss = np.concatenate(((poses - wanted)[:, :3, 3] / _LIKE.position, turn / _LIKE.angle), axis=1)
        tangent = np.concatenate(
            (self.line.shift / _LIKE.position, self.line.axis * self.line.angle / _LIKE.angle)
        )
        across = miss - np.outer(miss @ tangent / (tangent @ tangent), tangent)
        distance = np.linalg.norm(across[:, :3], axis=1).max() * _LIKE.position
        angle = np.linalg.norm(across[:, 3:], axis=1).max() * _LIKE.angle
        return float(distance), float(angle)


def along(
    chain: Chain, limits: Limits, flange_from_moving: Array, line: Line, q_start: Array
) -> LinePath | Broken:
    """Follow a line from where the robot stands, `q_start` (n,), keeping the configuration."""
    tracked = track(chain, limits, _flange(line, flange_from_moving), q_start)
    if isinstance(tracked, Broken):
        return tracked
    return LinePath(chain, flange_from_moving, line, q_start, tracked)


def _flange(line: Line, flange_from_moving: Array) -> Callable[[Array], Array]:
    moving_from_flange = np.linalg.inv(flange_from_moving)
    return lambda s: line.poses(s) @ moving_from_flange
