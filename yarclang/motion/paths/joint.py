"""Define a straight line in joint space."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array


@frozen(eq=False)
class JointPath:
    """A path in joint space from `start` to `end` (n,) [rad or m], along which all joints move in a
    constant ratio.
    """

    start: Array
    end: Array

    @property
    def slope(self) -> Array:
        """The slope of each joint over s (n,) [rad or m]."""
        slope: Array = np.abs(self.end - self.start)
        return slope

    @property
    def is_straight_in_joints(self) -> bool:
        """Always True."""
        return True

    @property
    def places(self) -> Array:
        """An empty array, since a straight line has no bends."""
        return np.empty(0)

    def joints(self, s: Array) -> Array:
        """Return joint positions (N, n) at `s` (N,)."""
        q: Array = self.start + s[:, None] * (self.end - self.start)
        return q

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:  # noqa: ARG002
        """Return zeros: control points on a straight line in joint space execute the line exactly."""
        return 0.0, 0.0
