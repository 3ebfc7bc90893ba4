"""Define the curve that a controller with uniform segments executes: a cubic B-spline in joint space.

A motion of n segments of h seconds has n + 3 control points. The first three equal its start and the last
three its end, so that it starts and ends at rest. With the control points f, at knot k (time k h):

    x = (f[k] + 4 f[k+1] + f[k+2]) / 6        v = (f[k+2] - f[k]) / 2h
    a = (f[k+2] - 2 f[k+1] + f[k]) / h^2      jerk = (f[k+3] - 3 f[k+2] + 3 f[k+1] - f[k]) / h^3

Acceleration is linear between knots, and jerk is constant in each segment. The velocity at any instant is in
the convex hull of the first differences over h. Therefore limits of velocity, acceleration and jerk hold at
all instants if they hold for the differences (de Boor, B-spline basics).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array

FEWEST_SEGMENTS = 4
"""Least number of segments. With fewer, no control point would be left between the three at the start and the
three at the end.
"""


@frozen(eq=False)
class Curve:
    """A motion from rest to rest, as a cubic B-spline over uniform segments.

    `points` (n + 3, d) are the control points [rad or m], and `segment` is the duration h of a segment [s].
    `law` (n + 3,) are the control values of the B-spline that gives the share of the path completed at each
    time; the points were computed from it.
    """

    points: Array
    segment: float
    law: Array

    @property
    def segments(self) -> int:
        """The number n of segments."""
        return len(self.points) - 3

    @property
    def duration(self) -> float:
        """The duration n h of the motion [s]."""
        return self.segments * self.segment

    def sample(self, times: Array) -> tuple[Array, Array, Array]:
        """Compute position, velocity and acceleration of the joints at given times.

        Args:
            times: (N,) in s from the start; outside the motion the robot is at rest.

        Returns:
            Three arrays (N, d) in rad (m), per s, per s^2.
        """
        along = np.clip(times / self.segment, 0.0, self.segments)
        k = np.minimum(along.astype(np.intp), self.segments - 1)
        return _values(self.points, k, (along - k)[:, None], self.segment)


class Sampler:
    """Sampler of many curves at once. The time for a sample doesn't depend on the number and length of the
    curves.
    """

    def __init__(self, curves: Sequence[Curve]) -> None:
        self._points = np.concatenate([curve.points for curve in curves])
        rows = np.array([len(curve.points) for curve in curves])
        self._first = np.cumsum(rows) - rows
        self._segments = rows - 3
        self._segment = np.array([curve.segment for curve in curves])

    def sample(self, number: NDArray[np.intp], times: Array) -> tuple[Array, Array, Array]:
        """Compute position, velocity and acceleration of the joints. Each sample has its own curve.

        The results are identical to those of `Curve.sample` to the last bit.

        Args:
            number: (N,) the index of the curve of each sample.
            times: (N,) in s from the start of that curve.

        Returns:
            Three arrays (N, d) in rad (m), per s, per s^2.
        """
        segment, segments = self._segment[number], self._segments[number]
        along = np.clip(times / segment, 0.0, segments)
        k = np.minimum(along.astype(np.intp), segments - 1)
        return _values(self._points, self._first[number] + k, (along - k)[:, None], segment[:, None])


def _values(
    points: Array, k: NDArray[np.intp], u: Array, segment: float | Array
) -> tuple[Array, Array, Array]:
    """Compute position, velocity and acceleration of the joints within segments of a curve.

    Args:
        points: the control points of the curve.
        k: (N,) the row of the first control point of each sample's segment.
        u: (N, 1) the elapsed share of the segment, from 0 to 1.
        segment: duration of the segments [s].
    """
    # Basis functions of the uniform cubic B-spline at the share u of a segment, and their derivatives.
    f0, f1, f2, f3 = (points[k + i] for i in range(4))
    w = 1.0 - u
    x = (
        w**3 * f0 + (3 * u**3 - 6 * u**2 + 4) * f1 + (-3 * u**3 + 3 * u**2 + 3 * u + 1) * f2 + u**3 * f3
    ) / 6.0
    v = (w**2 * (f1 - f0) + (1 + 2 * u - 2 * u**2) * (f2 - f1) + u**2 * (f3 - f2)) / (2.0 * segment)
    a = (w * (f2 - 2 * f1 + f0) + u * (f3 - 2 * f2 + f1)) / segment**2
    return x, v, a


def knot_values(points: Array) -> Array:
    """Return the values of a curve at its knots 0 to n, (n + 1, ...). `points` are its control points (n + 3,
    ...).
    """
    values: Array = (points[:-2] + 4.0 * points[1:-1] + points[2:]) / 6.0
    return values


def middle_values(points: Array) -> Array:
    """Return the values of a curve in the middle of its n segments, (n, ...), from its control points (n +
    3, ...).
    """
    # Basis functions of the uniform cubic B-spline in the middle of a segment: 1, 23, 23 and 1, over 48.
    values: Array = (points[:-3] + 23.0 * (points[1:-2] + points[2:-1]) + points[3:]) / 48.0
    return values


def through_knots(inner: Array, start: Array, end: Array) -> Array:
    """Return the control points of the curve that passes through given positions at the knots 2 to n - 2.

    The curve starts at rest at knot 0 and ends at rest at knot n. Positions at knots 1 and n - 1 can't be
    prescribed. There the curve is only close to the path; it is closer if the motion profile is smoother.

    Args:
        inner: (n - 3, d), the positions at knots 2 to n - 2.
        start: (d,), the position at knot 0.
        end: (d,), the position at knot n.

    Returns:
        (n + 3, d) control points.
    """
    # 6 x[k] = f[k] + 4 f[k+1] + f[k+2]: move the known control points to the right-hand side.
    right = 6.0 * inner
    right[0] -= start
    right[-1] -= end
    solved = solve_tridiagonal(np.full(len(inner), 4.0), np.ones(len(inner) - 1), right)
    return np.concatenate((np.tile(start, (3, 1)), solved, np.tile(end, (3, 1))))


def solve_tridiagonal(diagonal: Array, beside: Array, right: Array) -> Array:
    """Solve a symmetric, positive definite tridiagonal system.

    Args:
        diagonal: (m,) the diagonal; m is at least 1.
        beside: (m - 1,) the values next to the diagonal.
        right: (m, d) right-hand sides.

    Returns:
        The solutions (m, d).
    """
    from scipy.linalg import solveh_banded

    if len(diagonal) == 1:  # LAPACK's wrapper can't solve a single equation
        return right / diagonal[:, None]
    band = np.zeros((2, len(diagonal)))
    band[0, 1:], band[1] = beside, diagonal
    solved: Array = solveh_banded(band, right, check_finite=False)
    return solved
