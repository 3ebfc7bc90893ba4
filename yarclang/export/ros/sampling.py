"""Choose few waypoints on a path, such that every kind of interpolation between them stays within a
tolerance of the path.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.export.ros.course import Path
from yarclang.export.ros.interpolation import Interpolation, coefficients, largest, values
from yarclang.frozen import frozen
from yarclang.progress import tell
from yarclang.robot.model import Array

NS = 1e-9
"""One nanosecond [s], the unit of times in ROS."""
DECIMALS = 10, 9, 8
"""Numbers of decimals of positions, velocities and accelerations."""
_RESERVE = 1e-3
"""Fraction of the tolerance that the choice of waypoints doesn't use.

The proof divides the motion at the path's knots; the choice divides it at the nearest multiples of a
nanosecond. The bounds that both compute therefore differ slightly.
"""
_FINER = 3.0
"""Approximate number of candidates for straight lines in the longest interval that the tolerance allows."""
_UNITS = 8
"""The second choice of waypoints divides each interval of the first choice into this number of parts, and
takes the ends of parts as candidates.
"""
_ROWS = 3_000
"""Number of pieces that are examined at once. It limits the memory that is needed."""

Rows = NDArray[np.intp]
Mask = NDArray[np.bool_]


@frozen(eq=False)
class Points:
    """Waypoints of all stretches of a path (intervals of motion without a stop), in order.

    Attributes:
        stretch: (N,) index of the stretch.
        time: (N,) time since the start of the stretch [ns].
        x: (N, n) positions [rad or m].
        v: (N, n) velocities [rad/s or m/s].
        a: (N, n) accelerations [rad/s^2 or m/s^2].
    """

    stretch: Rows
    time: NDArray[np.int64]
    x: Array
    v: Array
    a: Array

    def take(self, rows: Rows) -> Points:
        """Return the points with the given indices."""
        return Points(self.stretch[rows], self.time[rows], self.x[rows], self.v[rows], self.a[rows])


def sampled(path: Path, tolerance: float, kinds: tuple[Interpolation, ...]) -> Points:
    """Choose few waypoints on a path such that several kinds of interpolation between them stay within a
    tolerance of the path.

    First, neighbouring intervals between candidates are joined as long as the joined interval keeps the
    tolerance. The remaining intervals are divided into parts. From each end of a part, the longest step that
    keeps the tolerance is found. The waypoints are reached by these steps from the start of each stretch.

    Args:
        path: the executed path.
        tolerance: largest deviation of each joint from the path, at equal times [rad or m].
        kinds: the kinds of interpolation.
    """
    candidates = _candidates(path, tolerance, "linear" in kinds)
    fits = _Fits(candidates, tolerance * (1.0 - _RESERVE), kinds)
    if not len(candidates.time):
        return candidates
    chosen = _joined(fits)
    return candidates.take(_stepped(fits, chosen))


def _candidates(path: Path, tolerance: float, straight: bool) -> Points:
    """Return candidates for waypoints: the knots of the path and, for straight lines, also points between
    the knots.
    """
    count = len(path.begin)
    parts = np.ones(count, dtype=np.intp)
    if straight and count:
        length = np.append(np.diff(path.begin), 0.0)
        length[path.last] = 0.0
        bend = np.maximum(np.abs(path.a), np.abs(path.a + path.jerk * length[:, None])).max(axis=1)
        parts = np.maximum(np.ceil(_FINER * length * np.sqrt(bend / (8.0 * tolerance))), 1).astype(np.intp)
    piece = np.repeat(np.arange(count), parts)
    own = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    begin = path.begin[piece]
    behind = np.append(path.begin[1:], 0.0)[piece]
    time = np.where(own > 0, begin + (behind - begin) * own / parts[piece], begin)
    whole = np.rint(time / NS).astype(np.int64)
    # The last point must not be before the robot is at rest.
    rest = np.isin(piece, path.last)
    whole[rest] = np.ceil(time[rest] / NS - 1e-3).astype(np.int64)
    x, v, a = path.at(piece, np.where(rest, 0.0, whole * NS - begin))
    x, v, a = (np.round(one, decimals) + 0.0 for one, decimals in zip((x, v, a), DECIMALS, strict=True))
    return Points(path.stretch[piece], whole, x, v, a)


class _Fits:
    """Checker that tests whether all kinds of interpolation keep the tolerance on intervals between
    candidates for waypoints.
    """

    def __init__(self, points: Points, tolerance: float, kinds: tuple[Interpolation, ...]) -> None:
        self.points = points
        self._tolerance, self._kinds = tolerance, kinds
        self._time = points.time * NS

    def __call__(self, first: Rows, second: Rows) -> Mask:
        """Return a mask (I,): True for each interval that keeps the tolerance.

        Args:
            first: (I,) candidates at the starts of the intervals.
            second: (I,) candidates at the ends of the intervals, each in the same stretch as the start.
        """
        sound = np.ones(len(first), dtype=np.bool_)
        ends = np.cumsum(second - first)
        begin = 0
        while begin < len(first):
            done = ends[begin - 1] if begin else 0
            end = max(int(np.searchsorted(ends, done + _ROWS, side="right")), begin + 1)
            sound[begin:end] = self._few(first[begin:end], second[begin:end])
            begin = end
        return sound

    def _few(self, first: Rows, second: Rows) -> Mask:
        p, time = self.points, self._time
        counts = second - first
        offsets = np.cumsum(counts) - counts
        which = np.repeat(np.arange(len(first)), counts)
        here = first[which] + np.arange(len(which)) - offsets[which]
        worst = np.zeros(len(here))
        length = time[here + 1] - time[here]
        since = time[here] - time[first][which]
        for kind in self._kinds:
            ends = tuple((p.x[at], p.v[at], p.a[at]) for at in (first, second))
            powers = coefficients(kind, ends[0], ends[1], time[second] - time[first])[:, which]
            begins, stops = values(powers, since), values(powers, since + length)
            off = tuple(one - other[here] for one, other in zip(begins, (p.x, p.v, p.a), strict=True))
            after = tuple(one - other[here + 1] for one, other in zip(stops, (p.x, p.v, p.a), strict=True))
            found = largest((off[0], off[1], off[2]), (after[0], after[1], after[2]), length, 1)
            np.maximum(worst, found.max(axis=1), out=worst)
        kept: Mask = np.maximum.reduceat(worst, offsets) <= self._tolerance
        return kept


def _joined(fits: _Fits) -> Rows:
    """Return a selection of the candidates for waypoints such that no two neighbouring intervals of a
    stretch can be joined within the tolerance.

    The selection has at most about twice as many candidates as necessary.
    """
    stretch = fits.points.stretch
    count = len(stretch)
    fixed = np.ones(count, dtype=np.bool_)
    fixed[1:-1] = (stretch[1:-1] != stretch[:-2]) | (stretch[1:-1] != stretch[2:])
    tried = np.full((count, 2), -1, dtype=np.intp)
    chosen = np.arange(count)
    going = True
    while going:
        going = False
        for parity in (1, 2):
            tell("choosing waypoints", count - len(chosen), count)
            middle = np.arange(parity, len(chosen) - 1, 2)
            left, here, right = chosen[middle - 1], chosen[middle], chosen[middle + 1]
            open_ = ~fixed[here] & ((tried[here, 0] != left) | (tried[here, 1] != right))
            middle, left, here, right = middle[open_], left[open_], here[open_], right[open_]
            sound = fits(left, right)
            tried[here, 0], tried[here, 1] = left, right
            chosen = np.delete(chosen, middle[sound])
            going = going or bool(sound.any())
    return chosen


def _stepped(fits: _Fits, chosen: Rows) -> Rows:
    """Return the candidates that are reached from the start of each stretch by the longest steps that keep
    the tolerance. The intervals between the `chosen` candidates are divided into parts, and steps end only at
    ends of parts.
    """
    stretch = fits.points.stretch
    places = _parts(chosen, np.minimum(np.diff(chosen), _UNITS))
    within = np.flatnonzero(stretch[places[:-1]] == stretch[places[1:]])
    unfit = within[~fits(places[within], places[within + 1])]
    if unfit.size:  # rare: if an interval keeps the tolerance, its parts nearly always do
        parts = np.ones(len(places) - 1, dtype=np.intp)
        parts[unfit] = np.diff(places)[unfit]
        places = _parts(places, parts)
    of = stretch[places]
    last = np.searchsorted(of, of, side="right") - 1
    most = np.minimum(last - np.arange(len(places)), 4 * _UNITS)
    # Binary search: steps of `low` parts keep the tolerance; steps of more than `high` parts don't, or aren't
    # tried.
    low, high = np.minimum(most, 1), most.copy()
    while (open_ := np.flatnonzero(low < high)).size:
        tell("choosing waypoints", int(np.count_nonzero(low >= high)), len(places))
        middle = (low[open_] + high[open_] + 1) // 2
        sound = fits(places[open_], places[open_ + middle])
        low[open_[sound]] = middle[sound]
        high[open_[~sound]] = middle[~sound] - 1
    step = np.arange(len(places)) + low
    met = np.zeros(len(places), dtype=np.bool_)
    met[np.flatnonzero(np.append(True, of[1:] != of[:-1]))] = True
    for _ in range(len(places).bit_length()):
        met[step[met]] = True
        step = step[step]
    return places[met]


def _parts(places: Rows, parts: Rows) -> Rows:
    """Return the given candidates, and further candidates between them, which divide each interval into the
    wanted number of parts.
    """
    which = np.repeat(np.arange(len(parts)), parts)
    own = np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts)
    return np.append(places[which] + own * np.diff(places)[which] // parts[which], places[-1])
