"""Define a straight line of the moving frame. Along the line, the frame turns about a fixed axis, in
proportion to the distance travelled.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.rotation import NO_TURN, turn_between, turned, turns_between


@frozen(eq=False)
class Line:
    """A straight line of the moving frame, as poses over s from `base_from_start` (4, 4) to `base_from_end`
    (4, 4).

    The frame moves by `shift` (3,) [m], over the distance `length` [m]. It turns by `angle` [rad] about the
    unit vector `axis` (3,), in the axes of {B}. It ends exactly at `base_from_end`, to the last bit, so that
    later motions don't depend on the digits of the start.
    """

    base_from_start: Array
    base_from_end: Array
    axis: Array
    angle: float
    length: float

    @property
    def shift(self) -> Array:
        """The translation of the frame (3,) [m]."""
        shift: Array = self.base_from_end[:3, 3] - self.base_from_start[:3, 3]
        return shift

    @property
    def is_point(self) -> bool:
        """True if the frame neither moves nor turns."""
        return self.length < 1e-12 and self.angle < NO_TURN

    def poses(self, s: Array) -> Array:
        """Return base_from_moving (N, 4, 4) at `s` (N,)."""
        poses: Array = poses_along([self], s)[0]
        return poses

    def tangents(self, s: Array) -> Array:
        """Return the derivatives of the frame's pose with respect to s, (N, 6); see `FramePath.tangents`.
        They are constant along the line.
        """
        return np.tile(np.concatenate((self.shift, self.axis * self.angle)), (len(s), 1))


def line_between(base_from_start: Array, base_from_end: Array) -> Line | None:
    """Return the straight line between two poses (4, 4), along which the frame turns by the smaller angle.
    The result is None if this angle is 180 deg, since the direction of rotation is then ambiguous.
    """
    turn = turn_between(base_from_start[:3, :3], base_from_end[:3, :3])
    if turn is None:
        return None
    shift: Array = base_from_end[:3, 3] - base_from_start[:3, 3]
    return Line(base_from_start, base_from_end, *turn, float(np.linalg.norm(shift)))


def lines_between(base_from_start: Array, goals: Sequence[Array]) -> list[Line | None]:
    """Return the straight lines from poses (M, 4, 4) to M goals (4, 4). They are identical to those of
    `line_between` to the last bit.
    """
    ends = np.array(goals)
    axes, angles = turns_between(base_from_start[:, :3, :3], ends[:, :3, :3])
    shifts = ends[:, :3, 3] - base_from_start[:, :3, 3]
    lengths = np.sqrt((shifts[:, None] @ shifts[:, :, None]).ravel()).tolist()
    parts = zip(base_from_start, goals, axes, angles.tolist(), lengths, strict=True)
    # NaN marks a rotation by 180 deg.
    return [Line(*part) if part[3] == part[3] else None for part in parts]


def poses_along(lines: Sequence[Line], s: Array) -> Array:
    """Return the poses base_from_moving (M, N, 4, 4) along each of M lines, at the places `s` (N,)."""
    starts = np.array([line.base_from_start for line in lines])
    axes = np.array([line.axis for line in lines])
    angles = s * np.array([line.angle for line in lines])[:, None]
    poses = np.zeros((len(lines), len(s), 4, 4))
    poses[..., :3, :3] = turned(starts[:, None, :3, :3], axes[:, None], angles)
    poses[..., :3, 3] = (
        starts[:, None, :3, 3] + s[:, None] * np.array([line.shift for line in lines])[:, None]
    )
    poses[..., 3, 3] = 1.0
    # Set the ends exactly, to the last bit, so that later motions don't depend on the digits of the start.
    poses[:, s == 1.0] = np.array([line.base_from_end for line in lines])[:, None]
    return poses
