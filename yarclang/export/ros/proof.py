"""Prove that a driver that interpolates between waypoints stays near the executed path.

The proof uses the rounded waypoints of the exported file, and the path that the judge (the independent
checker) has read. It doesn't depend on how the waypoints were chosen.
"""

from __future__ import annotations

import numpy as np

from yarclang.export.ros.course import Path
from yarclang.export.ros.interpolation import Interpolation, State, coefficients, largest, values
from yarclang.export.ros.sampling import NS, Points
from yarclang.robot.model import Array

_HALVINGS = 5
_ROWS = 50_000
"""Number of intervals that are examined at once."""


def deviation(path: Path, points: Points, kind: Interpolation) -> Array:
    """Return an upper bound on the distance between the executed path and the interpolation of waypoints, at
    equal times.

    The times of the waypoints and the knots of the path divide the motion into intervals. On each interval,
    interpolation and path are polynomials. Their difference is then a polynomial, too, and its Bernstein
    coefficients bound it.

    Args:
        path: the executed path.
        points: waypoints of all stretches of the path (intervals of motion without a stop), at least two for
            each.
        kind: kind of the interpolation.

    Returns:
        (n,) bound for each joint [rad or m].
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
        # At the last waypoint of a stretch no interpolation begins, so use the one that ends there. The
        # difference is at rest, and lasts at most a nanosecond.
        here = np.where(np.append(np.diff(points.stretch) > 0, True)[here], here - 1, here)
        ends = tuple((points.x[k], points.v[k], points.a[k]) for k in (here, here + 1))
        powers = coefficients(kind, ends[0], ends[1], time[here + 1] - time[here])
        differences: list[State] = []
        for when in (at[rows], at[rows + 1]):
            driven, executed = values(powers, when - time[here]), path.at(own, when - path.begin[own])
            x, v, a = (array - other for array, other in zip(driven, executed, strict=True))
            differences.append((x, v, a))
        first, second = differences
        length = at[rows + 1] - at[rows]
        found = largest(first, second, length, 1)
        # The largest difference at the ends of intervals is a lower bound on the result: refine only
        # intervals whose bound exceeds it.
        np.maximum(worst, np.abs(first[0]).max(axis=0), out=worst)
        close = (found > worst).any(axis=1)
        if close.any():
            x, v, a = (array[close] for array in first)
            y, w, b = (array[close] for array in second)
            found = largest((x, v, a), (y, w, b), length[close], _HALVINGS)
            np.maximum(worst, found.max(axis=0), out=worst)
    return worst
