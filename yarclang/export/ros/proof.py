"""The proof that a driver which follows way-points stays near the executed path.

It takes the numbers that are written, and the path as the judge has read it; how the way-points were chosen makes no difference.
"""

from __future__ import annotations

import numpy as np

from yarclang.export.ros.course import Path
from yarclang.export.ros.interpolation import Interpolation, State, coefficients, largest, values
from yarclang.export.ros.sampling import NS, Points
from yarclang.robot.model import Array

_HALVINGS = 5
_ROWS = 50_000
"""Intervals that are looked at at once."""


def deviation(path: Path, points: Points, kind: Interpolation) -> Array:
    """Bound how far an interpolation between way-points is from a path at the same time.

    Between two neighbouring times of the union of way-points and knots both are polynomials, and so is their difference; its bound is
    that of its Bernstein coefficients.

    Args:
        path: the executed path.
        points: the way-points of all its stretches, at least two of each.
        kind: of the interpolation.

    Returns:
        (n,) of each joint [rad or m].
    """
    worst = np.zeros(path.x.shape[1])
    time = points.time * NS
    stretch = np.concatenate((path.stretch, points.stretch))
    at = np.concatenate((path.begin, time))
    is_point = np.arange(len(at)) >= len(path.begin)
    order = np.lexsort((at, stretch))
    stretch, at, is_point = stretch[order], at[order], is_point[order]
    inside = np.flatnonzero((stretch[1:] == stretch[:-1]) & (at[1:] > at[:-1]))
    piece = np.cumsum(~is_point)[inside] - 1
    point = np.cumsum(is_point)[inside] - 1
    for begin in range(0, len(inside), _ROWS):
        few = slice(begin, begin + _ROWS)
        rows, own, here = inside[few], piece[few], point[few]
        # the rest after the last knot is driven to by the last interval, which ends within a nanosecond
        here = np.where(np.append(np.diff(points.stretch) > 0, True)[here], here - 1, here)
        ends = tuple((points.x[k], points.v[k], points.a[k]) for k in (here, here + 1))
        powers = coefficients(kind, ends[0], ends[1], time[here + 1] - time[here])
        differences: list[State] = []
        for when in (at[rows], at[rows + 1]):
            driven, executed = values(powers, when - time[here]), path.at(own, when - path.begin[own])
            x, v, a = (one - other for one, other in zip(driven, executed, strict=True))
            differences.append((x, v, a))
        first, second = differences
        length = at[rows + 1] - at[rows]
        found = largest(first, second, length, 1)
        # what is reached at an end is no less than the bound that is sought: only what may exceed that is looked at closely
        np.maximum(worst, np.abs(first[0]).max(axis=0), out=worst)
        close = (found > worst).any(axis=1)
        if close.any():
            x, v, a = (one[close] for one in first)
            y, w, b = (one[close] for one in second)
            found = largest((x, v, a), (y, w, b), length[close], _HALVINGS)
            np.maximum(worst, found.max(axis=0), out=worst)
    return worst
