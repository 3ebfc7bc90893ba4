"""Define a natural cubic spline in joint space through waypoints, whose parameter is the chord length."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.natural import NaturalSpline

_PLACES = 800
"""Approximate number of places on a spline at which its bends are examined."""

SAME_PLACE = 1e-12
"""Distance below which waypoints count as equal [rad or m]."""


@frozen(eq=False)
class SplinePath:
    """A path in joint space: the natural spline through waypoints; `prismatic` (n,) is True for prismatic
    joints.
    """

    spline: NaturalSpline
    prismatic: NDArray[np.bool_]

    @property
    def waypoints(self) -> Array:
        """The waypoints (w, n) [rad or m]."""
        return self.spline.values

    @property
    def start(self) -> Array:
        """The first waypoint."""
        start: Array = self.waypoints[0]
        return start

    @property
    def end(self) -> Array:
        """The last waypoint."""
        end: Array = self.waypoints[-1]
        return end

    @property
    def is_straight_in_joints(self) -> bool:
        """Always False: a spline is never assumed to be straight."""
        return False

    @property
    def slope(self) -> Array:
        """The largest absolute derivative of each joint with respect to s, approximately (n,) [rad or m]."""
        s = np.linspace(0.0, 1.0, 33)
        slope: Array = np.abs(np.diff(self.joints(s), axis=0)).max(axis=0) * (len(s) - 1)
        return slope

    @property
    def places(self) -> Array:
        """The places s of the waypoints except the last, and equally spaced places s on each leg (k,)."""
        knots = self.spline.knots
        between = max(1, _PLACES // (len(knots) - 1))
        inner: Array = knots[:-1, None] + np.diff(knots)[:, None] * np.arange(between) / between
        return inner.ravel()

    def joints(self, s: Array) -> Array:
        """Return joint positions (N, n) at `s` (N,)."""
        return self.spline.at(s)

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Return the largest distances between joint positions `q` (N, n) and the path at the places `s`
        (N,): of prismatic joints [m], and of revolute joints [rad].

        Being early or late along the path counts as a distance too: where a spline reverses, no direction is
        perpendicular to it.
        """
        miss = np.abs(q - self.joints(s))
        sliding = self.prismatic
        return float(miss[:, sliding].max(initial=0.0)), float(miss[:, ~sliding].max(initial=0.0))

    def extremes(self) -> tuple[Array, Array, Array, Array]:
        """Return the extremes of each joint along the path, (n,) each: the least value, its s, the largest
        value, its s.
        """
        return self.spline.extremes()


def through(waypoints: Array, prismatic: NDArray[np.bool_]) -> SplinePath:
    """Return the natural spline through waypoints in joint space.

    Args:
        waypoints: (w, n) [rad or m], no two neighbours equal, w at least 2.
        prismatic: (n,) True for prismatic joints.
    """
    chords = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    knots = np.concatenate(([0.0], np.cumsum(chords)))
    knots /= knots[-1]
    knots[-1] = 1.0
    return SplinePath(NaturalSpline.through(knots, waypoints), prismatic)


def distinct(waypoints: Array) -> Array:
    """Return the waypoints (w, n) without those that equal the previous one."""
    keep = np.ones(len(waypoints), dtype=bool)
    keep[1:] = np.linalg.norm(np.diff(waypoints, axis=0), axis=1) > SAME_PLACE
    return waypoints[keep]
