"""A straight line of the moving frame, turning about one fixed axis in step with it."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.rotation import NO_TURN, turn_between, turned


@frozen(eq=False)
class Line:
    """Poses of the moving frame over s: from `base_from_start` (4, 4) by `shift` (3,) [m], and by
    `angle` [rad] about the unit vector `axis` (3,), both in the axes of {B}, to `base_from_end` (4, 4).

    It ends there to the last bit: what comes behind doesn't depend on the digits of where it began.
    """

    base_from_start: Array
    base_from_end: Array
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
        poses = np.zeros((len(s), 4, 4))
        poses[:, :3, :3] = turned(self.base_from_start[:3, :3], self.axis, s * self.angle)
        poses[:, :3, 3] = self.base_from_start[:3, 3] + s[:, None] * self.shift
        poses[:, 3, 3] = 1.0
        poses[s == 1.0] = self.base_from_end
        return poses

    def tangents(self, s: Array) -> Array:
        """Velocities over s (N, 6): everywhere the same."""
        return np.tile(np.concatenate((self.shift, self.axis * self.angle)), (len(s), 1))


def line_between(base_from_start: Array, base_from_end: Array) -> Line | None:
    """The line between two poses (4, 4), the short way; None for half a turn, which has none."""
    turn = turn_between(base_from_start[:3, :3], base_from_end[:3, :3])
    if turn is None:
        return None
    shift: Array = base_from_end[:3, 3] - base_from_start[:3, 3]
    return Line(base_from_start, base_from_end, shift, *turn)
