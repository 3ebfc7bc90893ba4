"""What a path is: a curve in joint space over s from 0 to 1, with no time in it."""

from __future__ import annotations

from typing import Protocol

from yarclang.hir import Array


class Path(Protocol):
    """The programmed path of one motion, from `start` to `end` (n,) [rad or m]."""

    @property
    def start(self) -> Array:
        """Where it begins."""
        ...

    @property
    def end(self) -> Array:
        """Where it ends."""
        ...

    @property
    def is_straight_in_joints(self) -> bool:
        """Whether all joints keep one ratio: then control points on the line execute it exactly."""
        ...

    @property
    def slope(self) -> Array:
        """About the steepest slope of each joint over s (n,) [rad or m]."""
        ...

    @property
    def places(self) -> Array:
        """Places s (k,) that show the path's bends, where equal distances may be too few."""
        ...

    def joints(self, s: Array) -> Array:
        """Joint positions (N, n) at `s` (N,), ascending from 0 to 1."""
        ...

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """How far joint positions `q` (N, n), each near `s` (N,), are from the path.

        Returns:
            The largest distance in m and the largest angle in rad: of the moving frame for a
            Cartesian path, of prismatic and revolute joints for one in joint space.
        """
        ...
