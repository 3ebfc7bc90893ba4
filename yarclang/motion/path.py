"""Define a path: a curve in joint space over s from 0 to 1, without time."""

from __future__ import annotations

from typing import Protocol

from yarclang.hir import Array


class Path(Protocol):
    """The programmed path of one motion, from `start` to `end` (n,) [rad or m]."""

    @property
    def start(self) -> Array:
        """The first joint position (n,)."""
        ...

    @property
    def end(self) -> Array:
        """The last joint position (n,)."""
        ...

    @property
    def is_straight_in_joints(self) -> bool:
        """True if all joints move in a constant ratio; control points on the line then execute the path
        exactly.
        """
        ...

    @property
    def slope(self) -> Array:
        """The largest absolute derivative of each joint with respect to s along the path, approximately
        (n,) [rad or m].
        """
        ...

    @property
    def places(self) -> Array:
        """Places s (k,) that are denser where the path bends, for paths on which equally spaced places may be
        too few.
        """
        ...

    def joints(self, s: Array) -> Array:
        """Return joint positions (N, n) at ascending `s` (N,) from 0 to 1."""
        ...

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Return how far joint positions `q` (N, n), each near the place `s` (N,), are from the path.

        Returns:
            The largest distance in m and the largest angle in rad: of the moving frame for a Cartesian path,
            of prismatic and revolute joints for a path in joint space.
        """
        ...
