"""Choice of a path parameter s(t) for a motion along a curve.

Any choice gives a valid proof; a good one gives a sharp bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from yarclang.progress import go_on
from yarclang.robot.model import Array

_STIFFNESS = 1e-3
"""Weight of the third differences of s in the least squares (see `project`), relative to the typical |y'(s)|
of the curve.
"""
_PLACES, _BETWEEN = 1024, 4
"""Number of equal intervals in a table of a curve's length; least number of intervals between two waypoints.
"""
_AT_ONCE = 8_192
"""Number of points of a curve that are computed in one step."""
_ROUNDS = 5
"""Number of Gauss-Newton iterations."""


class Curve(Protocol):
    """A curve y(s) in any number of dimensions."""

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return y and y' at `s` (N,), (N, m) each; beyond its ends the curve continues."""
        ...


def project(curve: Curve, y: Array, rate: Array, guess: Array, pace: float, d: Array) -> tuple[Array, Array]:
    """Choose values and derivatives (N,) of s(t) at the points of a motion, so that y(s) is near each point.

    The method is a Gauss-Newton iteration for the least squares of y - y(s), starting from a guess in order
    of time. Where a curve turns back on itself, y' is zero and the position does not determine s. A small
    stiffness against third differences, which has almost no effect elsewhere, carries s smoothly through such
    a point.

    Args:
        curve: the curve, with each coordinate divided by its tolerance.
        y: (N, m) points of the motion, in order of time.
        rate: (N, m) velocities at these points.
        guess: (N,) approximate s.
        pace: typical |y'(s)|.
        d: (N - 1,) durations between the points [s].
    """
    from scipy.linalg import solveh_banded

    # The normal equations of Gauss-Newton have the squares of y' on the diagonal, plus the matrix of squared
    # third differences, which has three more bands.
    stiffness = (_STIFFNESS * pace) ** 2
    bands = _third_differences(len(guess)) * stiffness
    s = guess
    for _ in range(_ROUNDS):
        go_on()
        system, pull = bands.copy(), np.empty(len(s))
        for part in _parts(len(s)):
            at, slope = curve.at(s[part])
            system[0, part] += (slope**2).sum(axis=1) + 1e-9 * stiffness
            pull[part] = ((y[part] - at) * slope).sum(axis=1)
        s = s + solveh_banded(system, pull - _times(bands, s), lower=True, check_finite=False)
    go_on()
    # Choose s' by least squares of the velocities. Where y' vanishes, the stiffness makes s' the difference
    # quotient of s.
    about = np.gradient(s, np.concatenate([[0.0], np.cumsum(d)]))
    s_rate = np.empty(len(s))
    for part in _parts(len(s)):
        slope = curve.at(s[part])[1]
        steep = (slope**2).sum(axis=1)
        s_rate[part] = ((rate[part] * slope).sum(axis=1) + stiffness * about[part]) / (steep + stiffness)
    return s, s_rate


def _parts(count: int) -> Iterator[slice]:
    """Yield slices of at most `_AT_ONCE` rows that together cover `count` rows."""
    for begin in range(0, count, _AT_ONCE):
        go_on()
        yield slice(begin, begin + _AT_ONCE)


def _third_differences(size: int) -> Array:
    """Return the lower bands (4, size) of the matrix that gives the sum of squared third differences."""
    kernel = np.array([-1.0, 3.0, -3.0, 1.0])
    bands = np.zeros((4, size))
    for band in range(4):
        for first in range(4 - band):
            # Let D be the matrix of third differences. Entry (i, i + band) of D'D sums kernel[first]
            # kernel[first + band] over the differences that contain both points; at the ends of the motion
            # there are fewer differences.
            bands[band, first : size - 3 + first] += kernel[first] * kernel[first + band]
    return bands


def _times(bands: Array, x: Array) -> Array:
    """Return the product of a symmetric banded matrix, given by its lower bands, with x."""
    product = bands[0] * x
    for band in range(1, len(bands)):
        product[band:] += bands[band, :-band] * x[:-band]
        product[:-band] += bands[band, :-band] * x[band:]
    return np.asarray(product)


def table_of_lengths(curve: Curve, s: Array) -> Array:
    """Return the approximate length of a curve up to each parameter in `s` (N,), along a polygon."""
    lengths, behind = np.zeros(len(s)), 0.0
    for begin in range(0, len(s) - 1, _AT_ONCE):
        go_on()
        steps = np.linalg.norm(np.diff(curve.at(s[begin : begin + _AT_ONCE + 1])[0], axis=0), axis=1)
        lengths[begin + 1 : begin + 1 + len(steps)] = behind + np.cumsum(steps)
        behind = lengths[begin + len(steps)]
    return lengths


def guess_by_length(
    curve: Curve, y: Array, knots: Array, free: tuple[bool, bool] = (False, False)
) -> tuple[Array, float]:
    """Guess s at the points of a motion from the distance covered so far.

    Args:
        curve: the curve, from s = 0 to the last of `knots`.
        y: (N, m) points of the motion, in order of time.
        knots: (k,) parameters of the curve's waypoints, from 0 on.
        free: first value True if a blend joins the curve after its start (in its first half), second value
            True if a blend leaves it before its end.

    Returns:
        s (N,), and the curve's typical pace |y'(s)|.
    """
    end = float(knots[-1])
    s = places_of(knots)
    lengths = table_of_lengths(curve, s)
    # Sum up the polygon length of the motion up to each point. The guess is the point of the curve at the
    # same fraction of the curve's length.
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(y, axis=0), axis=1))])
    first, last = 0.0, lengths[-1]
    # A motion that joins the curve late begins at the nearest place in the first half; one that leaves it
    # early ends at the nearest place in the second half.
    half = int(np.searchsorted(s, end / 2.0))
    if free[0]:
        first = lengths[np.argmin(np.linalg.norm(curve.at(s[:half])[0] - y[0], axis=1))]
    if free[1]:
        last = lengths[half + np.argmin(np.linalg.norm(curve.at(s[half:])[0] - y[-1], axis=1))]
    way = first + run * ((last - first) / max(run[-1], 1e-300))
    return np.interp(way, lengths, s), float(lengths[-1] / end)


def places_of(knots: Array) -> Array:
    """Return parameters (N,) at which the points of a curve show its shape, for waypoints at `knots` (k,).

    The parameters are equally spaced. If there are many waypoints, some parameters between each two of them
    are added.
    """
    s = np.linspace(0.0, float(knots[-1]), _PLACES + 1)
    if (len(knots) - 1) * _BETWEEN <= _PLACES:
        return s
    between = knots[:-1, None] + np.diff(knots)[:, None] * (np.arange(_BETWEEN) / _BETWEEN)
    both: Array = np.sort(np.concatenate([s, between.ravel()]))
    return both
