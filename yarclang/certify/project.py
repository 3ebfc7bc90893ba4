"""A good parameter s(t) for a motion along a curve. Any would be lawful: a good one proves more."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from yarclang.progress import go_on
from yarclang.robot.model import Array

_STIFFNESS = 1e-3
_ROUNDS = 5


class Curve(Protocol):
    """A curve y(s) in any number of dimensions."""

    def at(self, s: Array) -> tuple[Array, Array]:
        """Y and y' at `s` (N,), (N, m) each; beyond the ends the curve goes on."""
        ...


def project(curve: Curve, y: Array, rate: Array, guess: Array, pace: float, d: Array) -> tuple[Array, Array]:
    """Values and derivatives (N,) of a good s(t) at the points of a motion.

    Least squares of y - y(s). Where a curve turns back on itself, y' is zero and the position doesn't say what s is: a
    little stiffness against third differences, of no effect elsewhere, carries s smoothly through. The guess, which knows which
    way it goes, starts the iteration.

    Args:
        curve: in coordinates that count the same, each against its tolerance.
        y: (N, m) the motion's points, in order of time.
        rate: (N, m) their velocities.
        guess: (N,) where s is about.
        pace: how fast the curve goes over s, typically.
        d: (N - 1,) durations between the points [s].
    """
    from scipy.linalg import solveh_banded

    stiffness = (_STIFFNESS * pace) ** 2
    bands = _third_differences(len(guess)) * stiffness
    s = guess
    for _ in range(_ROUNDS):
        go_on()
        at, slope = curve.at(s)
        system = bands.copy()
        system[0] += (slope**2).sum(axis=1) + 1e-9 * stiffness
        pull = ((y - at) * slope).sum(axis=1)
        s = s + solveh_banded(system, pull - _times(bands, s), lower=True, check_finite=False)
    go_on()
    slope = curve.at(s)[1]
    about = np.gradient(s, np.concatenate([[0.0], np.cumsum(d)]))
    steep = (slope**2).sum(axis=1)
    return s, ((rate * slope).sum(axis=1) + stiffness * about) / (steep + stiffness)


def _third_differences(size: int) -> Array:
    """The matrix of the sum of squared third differences, lower bands (4, size)."""
    kernel = np.array([-1.0, 3.0, -3.0, 1.0])
    bands = np.zeros((4, size))
    for band in range(4):
        for first in range(4 - band):
            bands[band, first : size - 3 + first] += kernel[first] * kernel[first + band]
    return bands


def _times(bands: Array, x: Array) -> Array:
    """The symmetric banded matrix times x."""
    product = bands[0] * x
    for band in range(1, len(bands)):
        product[band:] += bands[band, :-band] * x[:-band]
        product[:-band] += bands[band, :-band] * x[band:]
    return np.asarray(product)


def table_of_lengths(curve: Curve, s: Array) -> Array:
    """The length of the curve up to each of `s` (N,), about: that of the polygon through its points."""
    steps = np.linalg.norm(np.diff(curve.at(s)[0], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def guess_by_length(
    curve: Curve, y: Array, end: float, free: tuple[bool, bool] = (False, False)
) -> tuple[Array, float]:
    """Where s is about, by the length of the way so far, and the curve's typical pace.

    Args:
        curve: from s = 0 to `end`.
        y: (N, m) the motion's points, in order of time.
        end: the last s.
        free: whether the motion joins the curve elsewhere than at its start (in its first half), and leaves it before its end.
    """
    s = np.linspace(0.0, end, 1025)
    lengths = table_of_lengths(curve, s)
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(y, axis=0), axis=1))])
    first, last = 0.0, lengths[-1]
    half = len(s) // 2
    if free[0]:
        first = lengths[np.argmin(np.linalg.norm(curve.at(s[:half])[0] - y[0], axis=1))]
    if free[1]:
        last = lengths[half + np.argmin(np.linalg.norm(curve.at(s[half:])[0] - y[-1], axis=1))]
    way = first + run * ((last - first) / max(run[-1], 1e-300))
    return np.interp(way, lengths, s), float(lengths[-1] / end)
