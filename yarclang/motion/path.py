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
        """True if all joints move in a constant ratio: the path is a straight line in joint space. A curve
        with control points on this line follows the path exactly.
        """
        ...

    @property
    def slope(self) -> Array:
        """The approximate largest absolute derivative of each joint position with respect to s, (n,) [rad or
        m].
        """
        ...

    @property
    def places(self) -> Array:
        """Places s (k,) at which the path should be examined in addition to equally spaced places. They are
        closer together where the path bends.
        """
        ...

    def joints(self, s: Array) -> Array:
        """Return joint positions (N, n) at ascending `s` (N,) from 0 to 1."""
        ...

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Return the largest deviation of joint positions `q` (N, n) from the path near the places `s` (N,).

        Returns:
            The largest distance [m] and the largest angle [rad]. They are those of the moving frame for a
            Cartesian path, and those of prismatic and revolute joints for a path in joint space.
        """
        ...
