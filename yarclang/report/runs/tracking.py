"""Compare a run with its plan: find how far the program was at each sample (its program time), and the
robot's distance from the plan.

Program times include dwells, with the branches of a WHEN one after the other. For the search, dwells and
branches that weren't executed are cut out of the plan. What remains is the curve that the robot followed.
While the robot rested, the program times in the log are used as they are.

A sample's program time in the log comes from the number of lines that the controller has left. It is accurate
to one or two segments, and in a fast motion a segment is several degrees long. But commanded positions are on
the planned curve. Each time is therefore corrected to the time at which the curve is nearest to the commanded
position. If the curve returns to the same position, there are two such times; then the neighbouring samples
decide.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.planned import Planned
from yarclang.robot.model import Array

_LATE = 0.3
"""Largest error of a sample's program time in the log [s], in addition to the error of `_SEGMENTS` segments.
It has two causes: requests that were sent before the request for the sample, and a slow link.
"""

_SEGMENTS = 4.0
"""Additional error of a sample's program time in the log, as a number of segments."""

_SURE = 0.12
"""Largest error of a sample's program time after its correction by the controller's clock [s]."""

_NEAR = 1e-3
"""Two points of the planned curve count as equally near to a sample if their distances from the sample differ
by less than this [deg or mm].
"""

_SAME = 2e-3
"""Times that differ by less count as equal [s]."""

_DRIFT = 1e-3
"""Largest relative drift of the controller's clock against the computer's. Quartz clocks are ten times
better.
"""

_BESIDE = 0.02
"""Time before and after a rest [s]. Within it, the program time of a sample isn't determined by the nearest
point of the planned curve.
"""

_BESIDE_WAY = 0.12
"""Time after the beginning and before the end of a branch [s]. Within it, a program time in the log may
belong to the motion before or after the branch.
"""

_WITHIN = 1e-6
"""Time by which the cut of a skipped branch extends beyond the end of the branch [s]."""

_CANDIDATES = 65
_MINIMA = 3
_STEPS = 5
_ROWS = 2048
"""Number of samples that are computed at once, to bound the memory."""

_DOUBT = 1e-4
"""Penalty for a time at the end of the search window, as a distance [deg or mm]. It is so small that it
decides only between positions that are equal within a few counts, such as those of a robot at rest.
"""


@frozen(eq=False)
class Tracking:
    """The M samples of a run that belong to its program, compared with the plan.

    Attributes:
        rows: (M,) indices of the samples in the run.
        times: (M,) times of the program [s], never decreasing within a pass.
        off_path: (M, n) commanded position minus the nearest point of the planned path [rad or m].
        error: (M, n) actual position minus the planned position at that time [rad or m].
        breaks: (B,) samples before which a branch of a WHEN was left out, or another pass begins.
    """

    rows: NDArray[np.int64]
    times: Array
    off_path: Array
    error: Array
    breaks: NDArray[np.int64]


def tracking_of(run: RecordedRun, planned: Planned) -> Tracking:
    """Find the program time of each sample of a run, and compare the samples with the plan."""
    rows = np.flatnonzero(run.passes >= 0)
    times, nearest = np.empty(len(rows)), np.empty(len(rows))
    breaks = [np.empty(0, dtype=np.int64)]
    for part in _parts(run.passes[rows]):
        told = run.program_times[rows[part]]
        course = _course(planned, told)
        moved, nearest_ = _times_of_pass(run, course, rows[part])
        times[part], nearest[part] = course.with_dwells(moved, told), course.places(nearest_)
        left_out = np.searchsorted(times[part], course.skipped.mean(axis=1))
        breaks.append(part.start + np.concatenate(([0], left_out[left_out < len(moved)])))
    return Tracking(
        rows=rows,
        times=times,
        off_path=run.commanded[rows] - planned.at(nearest)[0],
        error=run.actual[rows] - planned.at(times)[0],
        breaks=np.unique(np.concatenate(breaks)[1:]) if len(rows) else breaks[0],
    )


def _parts(passes: NDArray[np.int64]) -> Iterator[slice]:
    """Yield the samples of each pass."""
    bounds = [0, *(np.flatnonzero(np.diff(passes)) + 1).tolist(), len(passes)] if len(passes) else []
    return (slice(first, behind) for first, behind in pairwise(bounds))


@frozen(eq=False)
class _Course:
    """The planned motion that one pass of a program followed, called its course: the motion of the program
    without dwells and without the branches that weren't executed.

    Attributes:
        planned: the whole planned motion.
        cut: (C, 2) disjoint intervals that are cut out, in order [s of the program].
        at_cut: (C,) times in the course at which these intervals were cut out [s].
        stands: (D,) times at which the robot rested [s of the course], each once.
        skipped: (W, 2) branches of a WHEN that were left out [s of the program].
    """

    planned: Planned
    cut: Array
    at_cut: Array
    stands: Array
    skipped: Array

    @property
    def duration(self) -> float:
        """Duration of the course [s]."""
        return self.planned.duration - float(np.diff(self.cut, axis=1).sum())

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return positions [rad or m] and velocities, (M, n) each, at times (M,) of the course [s]."""
        return self.planned.at(self.places(times))

    def segment_times(self, times: Array) -> Array:
        """Return the segment times (M,) [s] at times (M,) of the course [s]."""
        return self.planned.segment_times(self.places(times))

    def places(self, times: Array) -> Array:
        """Convert times (M,) of the course to times of the program [s]. The time at which an interval was cut
        out becomes the end of this interval.
        """
        longer = np.concatenate(([0.0], np.cumsum(np.diff(self.cut, axis=1))))
        found: Array = times + longer[np.searchsorted(self.at_cut, times, side="right")]
        return found

    def times(self, places: Array) -> Array:
        """Convert times (M,) of the program to times of the course [s]. All times in an interval that was cut
        out become the same time.
        """
        if not len(self.cut):
            return places
        at = np.searchsorted(self.cut[:, 0], places, side="right")
        last = np.maximum(at - 1, 0)
        behind: Array = self.at_cut[last] + np.maximum(places - self.cut[last, 1], 0.0)
        return np.where(at > 0, behind, places)

    def with_dwells(self, times: Array, logged: Array) -> Array:
        """Convert times (M,) of the course to times of the program [s], including dwells.

        Args:
            times: times of the course, never decreasing.
            logged: (M,) the program times in the log [s], which are used while the robot rested.
        """
        places = self.places(times)
        for stand in self.stands.tolist():
            ends = np.array([stand - _BESIDE, stand + _BESIDE])
            first, behind = np.searchsorted(times, ends).tolist()
            low, high = self.places(ends)
            low = max(float(low), 0.0)
            places[first:behind] = np.clip(logged[first:behind], low, min(high, self.planned.duration))
        rising: Array = np.maximum.accumulate(places)
        return rising


def _course(planned: Planned, logged: Array) -> _Course:
    """Return the planned motion that a pass followed, from its program times `logged` (M,) [s] in the log:
    without dwells, and without branches in which none of these times is.
    """
    ways = np.concatenate((planned.ways[:, :2], planned.ways[:, 1:]))
    when = np.sort(logged)
    # times near the ends of a branch may belong to the motion before or after the branch
    margin = np.minimum(_BESIDE_WAY, 0.4 * (ways[:, 1] - ways[:, 0]))
    first, behind = np.searchsorted(when, ways[:, 0] + margin), np.searchsorted(when, ways[:, 1] - margin)
    skipped = ways[(ways[:, 1] > ways[:, 0]) & (behind <= first)]
    # cut slightly beyond the end: at the end itself, the other branch begins, with the robot at another place
    skipped = skipped + np.array([0.0, _WITHIN])
    cut: list[tuple[float, float]] = []
    for begin, end in sorted((*skipped.tolist(), *planned.dwells.tolist())):
        if cut and begin < cut[-1][1]:
            cut[-1] = cut[-1][0], max(cut[-1][1], end)
        else:
            cut.append((begin, end))
    stretches = np.array(cut, dtype=np.float64).reshape(-1, 2)
    lengths = stretches[:, 1] - stretches[:, 0]
    at_cut = stretches[:, 0] - np.concatenate(([0.0], np.cumsum(lengths)[:-1]))[: len(lengths)]
    course = _Course(planned, stretches, at_cut, np.empty(0), skipped)
    return replace(course, stands=np.unique(course.times(planned.dwells[:, 0]).round(9)))


def _times_of_pass(run: RecordedRun, planned: _Course, rows: NDArray[np.int64]) -> tuple[Array, Array]:
    """Find the time of the course [s] that corresponds to each sample of one pass.

    Returns:
        Two arrays, with the time at which the planned curve is nearest to each sample. In the first array the
        times are corrected so that they never decrease from sample to sample. The second has them as found.
    """
    clock, points = run.times[rows] * (1.0 + _DRIFT), run.commanded[rows]
    units, told = run.robot.axis_units, planned.times(run.program_times[rows])
    window = _SEGMENTS * planned.segment_times(told) + _LATE
    about = clock - _never_falling(clock - told, np.ones(len(rows)))
    near = _nearest(planned, units, points, about, window)
    if near.alone.any():
        sure, when = _never_falling(near.times[near.alone], near.weights[near.alone]), clock[near.alone]
        # `sure` has the times of the samples to which only one time on the curve is nearest: interpolate
        # linearly between them. Before the first and after the last of these samples, follow the log.
        inside = np.clip(clock, when[0], when[-1])
        about = np.interp(inside, when, sure) + about - np.interp(inside, clock, about)
    near = _nearest(planned, units, points, about, np.full(len(rows), _SURE))
    return _never_falling(near.times, near.weights), near.times


def _never_falling(values: Array, weights: Array) -> Array:
    """Return the sequence that never decreases and is nearest to the given values (isotonic regression).
    Values with a large weight are changed least.
    """
    from scipy.optimize import isotonic_regression

    result: Array = isotonic_regression(values, weights=weights).x
    return result


@frozen(eq=False)
class _Nearest:
    """The times at which a planned curve is nearest to M points.

    Attributes:
        times: (M,) [s].
        weights: (M,) reliability of each time: the square of the curve's speed at this time.
        alone: (M,) True if the curve isn't equally near at another time.
    """

    times: Array
    weights: Array
    alone: NDArray[np.bool_]


def _nearest(planned: _Course, units: Array, points: Array, about: Array, window: Array) -> _Nearest:
    """Find the times at which the planned curve is nearest to points.

    Args:
        planned: the curve.
        units: (n,) units of the distances.
        points: (M, n) [rad or m].
        about: (M,) times around which to search [s].
        window: (M,) half width of the search [s].
    """
    parts = [slice(first, first + _ROWS) for first in range(0, len(points), _ROWS)]
    found = [_nearest_few(planned, units, points[part], about[part], window[part]) for part in parts]
    return _Nearest(
        np.concatenate([one.times for one in found]),
        np.concatenate([one.weights for one in found]),
        np.concatenate([one.alone for one in found]),
    )


def _nearest_few(planned: _Course, units: Array, points: Array, about: Array, window: Array) -> _Nearest:
    """Compute `_nearest` for a block of points, small enough that its data fit into memory."""
    doubt, places = ((_DOUBT / window) ** 2)[:, None], (points / units)[:, None]
    about = about[:, None]

    def curve(times: Array) -> tuple[Array, Array]:
        x, v = planned.at(times.ravel())
        return (x / units).reshape(*times.shape, -1), (v / units).reshape(*times.shape, -1)

    def cost(times: Array, x: Array) -> Array:
        total: Array = ((x - places) ** 2).sum(axis=2) + doubt * (times - about) ** 2
        return total

    shares = np.linspace(-1.0, 1.0, _CANDIDATES)
    tried = np.clip(about + shares * window[:, None], 0.0, planned.duration)
    costs = np.pad(cost(tried, curve(tried)[0]), ((0, 0), (1, 1)), constant_values=np.inf)
    is_least = (costs[:, 1:-1] <= costs[:, :-2]) & (costs[:, 1:-1] <= costs[:, 2:])
    some = np.argpartition(np.where(is_least, costs[:, 1:-1], np.inf), _MINIMA, axis=1)[:, :_MINIMA]
    best = np.take_along_axis(tried, some, axis=1)
    # Gauss-Newton steps from each minimum, limited to the interval between its neighbouring candidates.
    step = window[:, None] * (shares[1] - shares[0])
    low, high = np.maximum(best - step, 0.0), np.minimum(best + step, planned.duration)
    for _ in range(_STEPS):
        x, v = curve(best)
        slope = ((places - x) * v).sum(axis=2) - doubt * (best - about)
        best = np.clip(best + slope / ((v**2).sum(axis=2) + doubt), low, high)
    x, v = curve(best)
    final = np.where(np.take_along_axis(is_least, some, axis=1), cost(best, x), np.inf)
    nearest = np.argmin(final, axis=1)[:, None]
    times = np.take_along_axis(best, nearest, axis=1)
    # Costs are squared distances. Another minimum is equally near if its distance differs by only a few
    # counts.
    rivals = final < np.take_along_axis(final, nearest, axis=1) + _NEAR**2
    rivals &= (np.abs(best - times) > _SAME) & (np.abs(best - about) < 2.0 * _SURE)
    weights = np.take_along_axis((v**2).sum(axis=2) + doubt, nearest, axis=1)
    alone: NDArray[np.bool_] = ~np.any(rivals, axis=1, keepdims=True)
    return _Nearest(times[:, 0], weights[:, 0], alone[:, 0])
