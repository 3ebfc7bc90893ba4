"""A natural cubic spline in joint space through way-points, over the chord length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.motion.curve import solve_tridiagonal

SAME_PLACE = 1e-12
"""Way-points nearer than this [rad or m] count once."""


@dataclass(frozen=True, slots=True, eq=False)
class SplinePath:
    """The spline: `knots` (w,) from 0 to 1, `waypoints` (w, n) [rad or m], `bends` (w, n) second derivatives over s."""

    knots: Array
    waypoints: Array
    bends: Array
    prismatic: NDArray[np.bool_]

    @property
    def start(self) -> Array:
        """The first way-point."""
        start: Array = self.waypoints[0]
        return start

    @property
    def end(self) -> Array:
        """The last way-point."""
        end: Array = self.waypoints[-1]
        return end

    @property
    def is_straight_in_joints(self) -> bool:
        """Never assumed."""
        return False

    @property
    def slope(self) -> Array:
        """About the steepest slope of each joint over s (n,) [rad or m]."""
        s = np.linspace(0.0, 1.0, 33)
        slope: Array = np.abs(np.diff(self.joints(s), axis=0)).max(axis=0) * (len(s) - 1)
        return slope

    def joints(self, s: Array) -> Array:
        """Joint positions (N, n) at `s` (N,)."""
        leg = np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.knots) - 2)
        width = (self.knots[leg + 1] - self.knots[leg])[:, None]
        left = ((self.knots[leg + 1] - s)[:, None]) / width
        right = 1.0 - left
        q0, q1, m0, m1 = self.waypoints[leg], self.waypoints[leg + 1], self.bends[leg], self.bends[leg + 1]
        q: Array = left * q0 + right * q1 + ((left**3 - left) * m0 + (right**3 - right) * m1) * width**2 / 6.0
        return q

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Largest distance from where the law is on the path, of prismatic joints [m] and of revolute ones [rad].

        What is early or late along the path counts too: where a spline turns back on itself there is no across.
        """
        miss = np.abs(q - self.joints(s))
        sliding = self.prismatic
        return float(miss[:, sliding].max(initial=0.0)), float(miss[:, ~sliding].max(initial=0.0))

    def extremes(self) -> tuple[Array, Array, Array, Array]:
        """The least and the largest value of each joint (n,) and the s (n,) at which they are taken."""
        s = np.concatenate((self.knots, self._turning_points()))
        q = self.joints(s)
        low, high = np.argmin(q, axis=0), np.argmax(q, axis=0)
        joints = np.arange(q.shape[1])
        return q[low, joints], s[low], q[high, joints], s[high]

    def _turning_points(self) -> Array:
        """All s strictly inside the legs where some joint's derivative is zero."""
        width = np.diff(self.knots)[:, None]
        m0, m1 = self.bends[:-1], self.bends[1:]
        # with r from 0 to 1 on a leg, the derivative over s is a r^2 + b r + c
        a = (m1 - m0) * width / 2.0
        b = m0 * width
        c = np.diff(self.waypoints, axis=0) / width - (2.0 * m0 + m1) * width / 6.0
        with np.errstate(all="ignore"):
            root = np.sqrt(b**2 - 4 * a * c)
            half = -0.5 * (b + np.where(b < 0, -root, root))
            candidates = np.stack((half / a, c / half))
        inside = np.isfinite(candidates) & (candidates > 0) & (candidates < 1)
        s: Array = (self.knots[:-1, None] + candidates * width)[inside]
        return s


def through(waypoints: Array, prismatic: NDArray[np.bool_]) -> SplinePath:
    """The natural spline through `waypoints` (w, n) [rad or m], no two neighbours equal, w at least 2.

    `prismatic` (n,) says which joints slide.
    """
    chords = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    knots = np.concatenate(([0.0], np.cumsum(chords)))
    knots /= knots[-1]
    knots[-1] = 1.0
    bends = np.zeros_like(waypoints)
    if len(waypoints) > 2:
        width = np.diff(knots)
        slope = np.diff(waypoints, axis=0) / width[:, None]
        bends[1:-1] = solve_tridiagonal(
            2.0 * (width[:-1] + width[1:]), width[1:-1], 6.0 * np.diff(slope, axis=0)
        )
    return SplinePath(knots, waypoints, bends, prismatic)


def distinct(waypoints: Array) -> Array:
    """The way-points (w, n) without those that equal the one before."""
    keep = np.ones(len(waypoints), dtype=bool)
    keep[1:] = np.linalg.norm(np.diff(waypoints, axis=0), axis=1) > SAME_PLACE
    return waypoints[keep]
