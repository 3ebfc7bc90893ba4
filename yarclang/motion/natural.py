"""Compute the natural cubic spline through points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.curve import solve_tridiagonal


@frozen(eq=False)
class NaturalSpline:
    """A natural cubic spline through values at knots.

    `knots` (w,) go from 0 to 1, `values` (w, d) are the values there, and `bends` (w, d) the second
    derivatives, which are zero at the ends.
    """

    knots: Array
    values: Array
    bends: Array

    @staticmethod
    def through(knots: Array, values: Array) -> NaturalSpline:
        """Return the natural spline with `values` (w, d) at ascending `knots` (w,); w at least 2."""
        bends = np.zeros_like(values)
        if len(values) > 2:
            width = np.diff(knots)
            slope = np.diff(values, axis=0) / width[:, None]
            # Continuity of the first derivative: w m + 2 (w + w') m' + w' m'' = 6 (slope' - slope) at each
            # inner knot, with m = 0 at both ends.
            bends[1:-1] = solve_tridiagonal(
                2.0 * (width[:-1] + width[1:]), width[1:-1], 6.0 * np.diff(slope, axis=0)
            )
        return NaturalSpline(knots, values, bends)

    def at(self, s: Array) -> Array:
        """Return the values of the spline (N, d) at the places `s` (N,)."""
        leg, width, left = self._legs(s)
        right = 1.0 - left
        v0, v1, m0, m1 = self.values[leg], self.values[leg + 1], self.bends[leg], self.bends[leg + 1]
        # Cubic from its values and second derivatives at both ends of a leg.
        v: Array = left * v0 + right * v1 + ((left**3 - left) * m0 + (right**3 - right) * m1) * width**2 / 6.0
        return v

    def slope_at(self, s: Array) -> Array:
        """Return the first derivatives of the spline (N, d) at the places `s` (N,)."""
        return self.slope_on(self._leg(s), s[:, None])[:, 0]

    def slope_on(self, leg: NDArray[np.intp], s: Array) -> Array:
        """Return the first derivatives (N, k, d) of the spline at places `s` (N, k) on its legs `leg`
        (N,).
        """
        width = (self.knots[leg + 1] - self.knots[leg])[:, None, None]
        left = (self.knots[leg + 1, None] - s)[:, :, None] / width
        right = 1.0 - left
        rise = (self.values[leg + 1] - self.values[leg])[:, None] / width
        m0, m1 = self.bends[leg][:, None], self.bends[leg + 1][:, None]
        # Derivative of the form in `at`, with left' = -1 / width and right' = 1 / width.
        slope: Array = rise + ((1.0 - 3.0 * left**2) * m0 - (1.0 - 3.0 * right**2) * m1) * width / 6.0
        return slope

    def extremes(self) -> tuple[Array, Array, Array, Array]:
        """Return the extremes of each component of the spline, (d,) each: the least value, its place s, the
        largest value, its place s.
        """
        s = np.concatenate((self.knots, self._turning_points()))
        values = self.at(s)
        low, high = np.argmin(values, axis=0), np.argmax(values, axis=0)
        return np.amin(values, axis=0), s[low], np.amax(values, axis=0), s[high]

    def _legs(self, s: Array) -> tuple[NDArray[np.intp], Array, Array]:
        """For each place `s` (N,), return the index of the leg on which it lies (N,), the width of this leg
        (N, 1), and the share of the leg that is beyond `s` (N, 1).
        """
        leg = self._leg(s)
        width = (self.knots[leg + 1] - self.knots[leg])[:, None]
        return leg, width, (self.knots[leg + 1] - s)[:, None] / width

    def _leg(self, s: Array) -> NDArray[np.intp]:
        """Return, for each `s` (N,), the number of the leg on which it lies (N,)."""
        return np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.knots) - 2)

    def _turning_points(self) -> Array:
        """Return all s strictly inside the legs of the spline at which the derivative of some component is
        zero.
        """
        width = np.diff(self.knots)[:, None]
        m0, m1 = self.bends[:-1], self.bends[1:]
        # With r from 0 to 1 on a leg, the derivative with respect to s is a r² + b r + c.
        a = (m1 - m0) * width / 2.0
        b = m0 * width
        c = np.diff(self.values, axis=0) / width - (2.0 * m0 + m1) * width / 6.0
        with np.errstate(all="ignore"):
            root = np.sqrt(b**2 - 4 * a * c)
            # Compute both roots without cancellation: q / a and c / q with q = -(b ± root) / 2.
            half = -0.5 * (b + np.where(b < 0, -root, root))
            candidates = np.stack((half / a, c / half))
        inside = np.isfinite(candidates) & (candidates > 0) & (candidates < 1)
        s: Array = (self.knots[:-1, None] + candidates * width)[inside]
        return s
