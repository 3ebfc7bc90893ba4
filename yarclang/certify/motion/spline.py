"""Deviation of a motion from the natural cubic spline through waypoints in joint space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.motion.bounds import HERMITE, JUMP, Cubics, catch_up, hermite_bezier
from yarclang.certify.motion.project import guess_by_length, project
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array

REMAINDER_SHARE = 0.02
"""Fraction of the tolerance that the remainder of the proof (the bound of the error between computed points)
should not exceed. It determines the number of pieces.
"""
MOST_PIECES = 16
"""Largest number of pieces of a segment."""
SAME = 1e-9
"""Distance [rad or m] below which neighbours count as one waypoint."""


@frozen(eq=False)
class NaturalSpline:
    """The cubic spline y(s) through m waypoints, with y'' = 0 at both ends.

    Attributes:
        s: (m,) chord length up to each waypoint: the sum of the Euclidean distances of joint positions in
            rad and m.
        y: (m, n) waypoints.
        bend: (m, n) y'' at the waypoints.
    """

    s: Array
    y: Array
    bend: Array

    @staticmethod
    def through(points: Array) -> NaturalSpline:
        """Return the spline through `points` (m, n) over chord length; equal neighbours count as one."""
        apart = np.linalg.norm(np.diff(points, axis=0), axis=1) > SAME
        y = points[np.concatenate([[True], apart])]
        return NaturalSpline.over(np.linalg.norm(np.diff(y, axis=0), axis=1), y)

    @staticmethod
    def over(steps: Array, y: Array) -> NaturalSpline:
        """Return the spline through `y` (m, n) over a parameter that grows by `steps` (m - 1,)."""
        s = np.concatenate([[0.0], np.cumsum(steps)])
        bend = np.zeros_like(y)
        if len(y) > 2:
            slope = np.diff(y, axis=0) / steps[:, None]
            # y' must be continuous at each inner waypoint. With the spans h0 and h1 beside it, this means h0
            # b0 + 2 (h0 + h1) b1 + h1 b2 = 6 (slope1 - slope0) for the second derivatives b, with b = 0 at
            # both ends of the natural spline.
            bend[1:-1] = _solve_tridiagonal(
                steps[1:-1], 2.0 * (steps[:-1] + steps[1:]), 6.0 * np.diff(slope, axis=0)
            )
        return NaturalSpline(s, y, bend)

    def span(self, s: Array) -> NDArray[np.int64]:
        """Return the index of the span between waypoints that contains each `s`.

        The first span also counts before the start, the last one after the end.
        """
        return np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, len(self.s) - 2)

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return y and y' at `s` (N,), (N, n) each; beyond its ends the cubic continues."""
        i = self.span(s)
        # The values and second derivatives at both ends of a span give its cubic, here as a Taylor polynomial
        # at its start.
        chord, t = (self.s[i + 1] - self.s[i])[:, None], (s - self.s[i])[:, None]
        b0, b1 = self.bend[i], self.bend[i + 1]
        third = (b1 - b0) / chord
        slope = (self.y[i + 1] - self.y[i]) / chord - chord * (2.0 * b0 + b1) / 6.0
        return self.y[i] + t * (slope + t * (b0 / 2.0 + t * third / 6.0)), slope + t * (b0 + t * third / 2.0)

    def bends(self, s: Array) -> Array:
        """Return y'' at `s` (N,), (N, n)."""
        i = self.span(s)
        share = ((s - self.s[i]) / (self.s[i + 1] - self.s[i]))[:, None]
        return (1.0 - share) * self.bend[i] + share * self.bend[i + 1]


def _solve_tridiagonal(beside: Array, diagonal: Array, right: Array) -> Array:
    """Solve a symmetric tridiagonal system; pivoting is unnecessary, since the diagonal is dominant.

    Args:
        beside: (m - 1,) entries beside the diagonal.
        diagonal: (m,) diagonal.
        right: (m, n) right sides.
    """
    from scipy.linalg import solveh_banded

    if len(diagonal) == 1:  # LAPACK's wrapper rejects a system of one equation
        return right / diagonal[:, None]
    band = np.zeros((2, len(diagonal)))
    band[0, 1:], band[1] = beside, diagonal
    solved: Array = solveh_banded(band, right, check_finite=False)
    return solved


@frozen(eq=False)
class SplineBound:
    """Proved deviation of the joints from a spline.

    Attributes:
        deviation: (n,) largest deviation of each joint [rad or m].
        remainder: (n,) part of `deviation` that bounds the error between computed points [rad or m].
        covered: (2,) range of the spline's parameter that was followed, as fractions of the whole range.
    """

    deviation: Array
    remainder: Array
    covered: Array


def spline_deviation(
    cubics: Cubics,
    waypoints: Array,
    weights: Array,
    law: Array | None = None,
    free: tuple[bool, bool] = (False, False),
) -> SplineBound:
    """Bound the deviation of a motion from the natural spline through waypoints.

    The error of each joint is e(t) = q(t) - y(s(t)), with s(t) piecewise cubic. As q'''' = 0 and y'''' = 0,
    |e''''| is at most 6 s'^2 |s''| |y'''| + (3 s''^2 + 4 |s' s'''|) |y''|. Where s passes a waypoint, e'''
    jumps by s'^3 times the jump of y'''. The Hermite remainder (see `yarclang.certify.motion.bounds`) follows
    from both.

    Args:
        cubics: the segments of one command, all of one duration.
        waypoints: (m, n) current position, and the waypoints after it.
        weights: (n,) reciprocal of the tolerance of each joint.
        law: (segments + 3,) fraction of the path over time as the planner claims it: control values of a
            cubic B-spline. A wrong claim does no harm: any s(t) from start to end gives a valid bound.
        free: first value True if a blend joins the spline after its start, second value True if a blend
            leaves it before its end.
    """
    spline = NaturalSpline.through(waypoints)
    if len(spline.y) == 1:
        lower, upper = cubics.position_range()
        away = np.maximum(np.abs(lower - spline.y), np.abs(upper - spline.y)).max(axis=0)
        return SplineBound(away, np.zeros_like(away), np.array([0.0, 1.0]))
    claimed = law if law is not None and len(law) == len(cubics.h) + 3 and np.isfinite(law).all() else None
    bound = _proved(cubics, spline, weights, claimed, free)
    if claimed is not None and (bound.deviation * weights).max() > 1.0:
        projected = _proved(cubics, spline, weights, None, free)
        bound = min(bound, projected, key=lambda one: float((one.deviation * weights).max()))
    return bound


def _proved(
    cubics: Cubics, spline: NaturalSpline, weights: Array, law: Array | None, free: tuple[bool, bool]
) -> SplineBound:
    """Compute the bound from pieces so short that the remainder is a small fraction of the tolerance, if at
    most `MOST_PIECES` pieces per segment are enough for that.
    """
    pieces = 1 if len(cubics.h) >= 4 else 4  # third differences need four points
    while True:
        go_on()
        bound = _bound(cubics, spline, weights, pieces, law, free)
        need = float((bound.remainder * weights).max()) / REMAINDER_SHARE
        if not need > 1.0 or pieces == MOST_PIECES:
            return bound
        # The remainder falls with the fourth power of the number of pieces.
        pieces = min(MOST_PIECES, max(pieces + 1, int(np.ceil(pieces * min(need, 1e6) ** 0.25))))


@frozen(eq=False)
class _Weighed:
    """A spline in joint coordinates that are divided by their tolerances."""

    spline: NaturalSpline
    weights: Array

    def at(self, s: Array) -> tuple[Array, Array]:
        y, slope = self.spline.at(s)
        return y * self.weights, slope * self.weights


def _bound(
    cubics: Cubics,
    spline: NaturalSpline,
    weights: Array,
    pieces: int,
    law: Array | None,
    free: tuple[bool, bool],
) -> SplineBound:
    # Compute joint positions and velocities at the ends of all pieces.
    count = len(cubics.h) * pieces
    segment = np.arange(count) // pieces
    # Cut each segment into equal pieces of time.
    d = cubics.h[segment] / pieces
    starts = cubics.take(segment)
    offset = (np.arange(count) % pieces) * d
    q, rate = starts.at(offset)
    q_end, rate_end = starts.at(offset + d)
    q, rate = np.concatenate([q, q_end[-1:]]), np.concatenate([rate, rate_end[-1:]])
    end = float(spline.s[-1])
    if law is None:
        curve = _Weighed(spline, weights)
        guess, pace = guess_by_length(curve, q * weights, spline.s, free)
        s, s_rate = project(curve, q * weights, rate * weights, guess, pace, d)
    else:
        s, s_rate = _claimed(law * end, float(cubics.h[0]), pieces)

    go_on()
    y, slope = spline.at(s)
    # Compute the error and its rate at the ends of pieces. They define the error's Hermite cubic.
    e, e_rate = q - y, rate - slope * s_rate[:, None]
    hull = np.stack(hermite_bezier(e[:-1], e_rate[:-1], e[1:], e_rate[1:], d[:, None]))
    bezier_s = np.stack(hermite_bezier(s[:-1], s_rate[:-1], s[1:], s_rate[1:], d), axis=1)
    rest = _remainder(spline, bezier_s, d)
    covered = np.where(free, np.clip([s[0] / end, s[-1] / end], 0.0, 1.0), [0.0, 1.0])
    lag = catch_up(bezier_s, np.zeros(count, dtype=np.int64), end, covered[None])
    reach = _steepest(spline, float(max(-bezier_s.min(), bezier_s.max() - end, 0.0)))
    # The bound is the largest Bezier point, plus the remainder, plus the path's largest slope times the lag
    # of s (see `catch_up`).
    deviation = np.abs(hull).max(axis=0) + rest + lag[:, None] * reach
    return SplineBound(deviation.max(axis=0), rest.max(axis=0), covered)


def _claimed(control: Array, h: float, pieces: int) -> tuple[Array, Array]:
    """Return values and derivatives of a claimed cubic B-spline s(t) at the points between pieces.

    Args:
        control: (segments + 3,) control values.
        h: duration of a segment [s].
        pieces: number of pieces of each segment.
    """
    count = (len(control) - 3) * pieces + 1
    k = np.minimum(np.arange(count) // pieces, len(control) - 4)
    u = np.arange(count) / pieces - k
    w = 1.0 - u
    # Use the basis functions of the uniform cubic B-spline at u in [0, 1], times 6, and their derivatives,
    # times 2.
    f0, f1, f2, f3 = (control[k + i] for i in range(4))
    s = (
        w**3 * f0 + (3 * u**3 - 6 * u**2 + 4) * f1 + (-3 * u**3 + 3 * u**2 + 3 * u + 1) * f2 + u**3 * f3
    ) / 6.0
    rate = (w**2 * (f1 - f0) + (1 + 2 * u - 2 * u**2) * (f2 - f1) + u**2 * (f3 - f2)) / (2.0 * h)
    return s, rate


def _remainder(spline: NaturalSpline, bezier_s: Array, d: Array) -> Array:
    """Bound the distance of e(t) from its Hermite cubic on each piece (P, n)."""
    # Compute the Bezier points of s' and s'', and s''', which is constant since s(t) is a cubic.
    ds = np.diff(bezier_s, axis=1) * (3.0 / d)[:, None]
    dds = np.diff(ds, axis=1) * (2.0 / d)[:, None]
    s3 = (np.abs(np.diff(dds, axis=1)[:, 0]) / d)[:, None]
    s1, s2 = np.abs(ds).max(axis=1)[:, None], np.abs(dds).max(axis=1)[:, None]
    # y'' is linear and y''' constant on a span: ends of the piece and waypoints inside it bound both.
    lower, upper = bezier_s.min(axis=1), bezier_s.max(axis=1)
    third = np.diff(spline.bend, axis=0) / np.diff(spline.s)[:, None]
    low, high = spline.span(lower), spline.span(upper)
    bend = np.maximum(np.abs(spline.bends(lower)), np.abs(spline.bends(upper)))
    sharp = np.maximum(np.abs(third[low]), np.abs(third[high]))
    jump = np.zeros_like(bend)
    (several,) = np.nonzero(high > low)
    # Sum the jumps up to each waypoint; the difference of two sums is that of the waypoints inside a piece.
    jumps = np.concatenate([np.zeros((1, third.shape[1])), np.cumsum(np.abs(np.diff(third, axis=0)), axis=0)])
    jump[several] = jumps[high[several]] - jumps[low[several]]
    for row in several:  # few pieces contain a waypoint
        inside = slice(low[row] + 1, high[row] + 1)
        bend[row] = np.maximum(bend[row], np.abs(spline.bend[inside]).max(axis=0))
        sharp[row] = np.maximum(sharp[row], np.abs(third[low[row] : high[row] + 1]).max(axis=0))
    # The cubic s(t) takes a value once, or at most three times if it turns back.
    jump *= np.where((ds.min(axis=1) < 0.0) & (ds.max(axis=1) > 0.0), 3.0, 1.0)[:, None]
    # By Faa di Bruno's formula, this bounds the fourth derivative of y(s(t)), since y'''' = s'''' = 0.
    change: Array = 6.0 * s1 * s1 * s2 * sharp + (3.0 * s2 * s2 + 4.0 * s1 * s3) * bend
    rest: Array = HERMITE * d[:, None] ** 4 * change + JUMP * d[:, None] ** 3 * s1**3 * jump
    return rest


def _steepest(spline: NaturalSpline, beyond: float) -> Array:
    """Return max |y'| of each joint (n,) on the spline, and up to `beyond` before and after it.

    The Bezier points of y' bound it.
    """
    chord = np.diff(spline.s)[:, None]
    b0, b1 = spline.bend[:-1], spline.bend[1:]
    slope = np.diff(spline.y, axis=0) / chord - chord * (2.0 * b0 + b1) / 6.0
    # The parabola y' has three Bezier points: both ends, and the intersection of the tangents there.
    middle = slope + chord * b0 / 2.0
    end = slope + chord * (b0 + b1) / 2.0
    inside = np.abs(np.stack([slope, middle, end])).max(axis=(0, 1))
    third = np.abs((b1 - b0) / chord).max(axis=0)
    steepest: Array = inside + beyond * (np.abs(spline.bend).max(axis=0) + beyond * third)
    return steepest
