"""How a run kept to its plan: when in the program each sample was taken, and how far from there the robot was.

A sample's program time comes from how many lines the controller has left: it is good to a segment or two, and a segment of a fast
motion is degrees long. But what is commanded lies on the planned curve: the time is taken where the curve is nearest to it. Where
the curve turns back on itself, it is near twice; there the clock decides: no program gains on it, so that how far the
program is behind it never falls.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from yarclang.report.run_log import RecordedRun
from yarclang.report.run_planned import Planned
from yarclang.robot.model import Array

_LATE = 0.3
"""How far a sample's program time may be off [s], besides the segments: what was asked before it, and a slow link."""

_SEGMENTS = 4.0
"""And how many segments."""

_SURE = 0.12
"""How far a time may be off that the clock has put right [s]."""

_DRIFT = 1e-3
"""How much faster than the host's clock the controller's may be; quartzes are ten times better."""

_CANDIDATES = 65
_MINIMA = 3
_STEPS = 5
_ROWS = 2048
"""Samples at once: enough for whole-array work, few enough for memory."""

_DOUBT = 1e-4
"""A time at the end of the window is as bad as this distance [deg or mm]: a few counts decide where nothing moves, and only there."""


@dataclass(frozen=True, slots=True, eq=False)
class Tracking:
    """The samples of a run against its plan; only those of the program itself, M of them.

    Attributes:
        rows: (M,) which samples of the run.
        times: (M,) of the program [s]; they never fall within a pass.
        off_path: (M, n) what is commanded, less the point of the planned path that is nearest to it [rad or m].
        error: (M, n) where the robot is, less where the program is at that time [rad or m].
    """

    rows: NDArray[np.int64]
    times: Array
    off_path: Array
    error: Array


def tracking_of(run: RecordedRun, planned: Planned) -> Tracking:
    """Find for each sample when in the program it was taken."""
    rows = np.flatnonzero(run.passes >= 0)
    times, nearest = np.empty(len(rows)), np.empty(len(rows))
    for part in _parts(run.passes[rows]):
        times[part], nearest[part] = _times_of_pass(run, planned, rows[part])
    return Tracking(
        rows=rows,
        times=times,
        off_path=run.commanded[rows] - planned.at(nearest)[0],
        error=run.actual[rows] - planned.at(times)[0],
    )


def _parts(passes: NDArray[np.int64]) -> Iterator[slice]:
    """Each pass."""
    bounds = [0, *(np.flatnonzero(np.diff(passes)) + 1).tolist(), len(passes)] if len(passes) else []
    return (slice(first, behind) for first, behind in pairwise(bounds))


def _times_of_pass(run: RecordedRun, planned: Planned, rows: NDArray[np.int64]) -> tuple[Array, Array]:
    """Program times [s] of the samples of one pass: those that never fall, and those where the curve is nearest."""
    clock, points = run.times[rows] * (1.0 + _DRIFT), run.commanded[rows]
    units, told = run.robot.axis_units, run.program_times[rows]
    window = _SEGMENTS * planned.segment_times(told) + _LATE
    about = clock - _never_falling(clock - told, np.ones(len(rows)))
    times, weights = _nearest(planned, units, points, about, window)
    about = clock - _never_falling(clock - times, weights)
    times, weights = _nearest(planned, units, points, about, np.full(len(rows), _SURE))
    return _never_falling(times, weights), times


def _never_falling(values: Array, weights: Array) -> Array:
    """The nearest values that never fall; those with much weight are moved least."""
    from scipy.optimize import isotonic_regression

    result: Array = isotonic_regression(values, weights=weights).x
    return result


def _nearest(
    planned: Planned, units: Array, points: Array, about: Array, window: Array
) -> tuple[Array, Array]:
    """When the planned curve is nearest to points.

    Args:
        planned: the curve.
        units: (n,) in which distances are measured.
        points: (M, n) [rad or m].
        about: (M,) the times that are looked around [s].
        window: (M,) how far to look [s].

    Returns:
        The times (M,) [s], and how much each of them says: the square of the speed there.
    """
    parts = [slice(first, first + _ROWS) for first in range(0, len(points), _ROWS)]
    found = [_nearest_few(planned, units, points[part], about[part], window[part]) for part in parts]
    times, weights = (np.concatenate(values) for values in zip(*found, strict=True))
    return times, weights


def _nearest_few(
    planned: Planned, units: Array, points: Array, about: Array, window: Array
) -> tuple[Array, Array]:
    """`_nearest` for as many as fit into memory."""
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
    # Gauss and Newton, not beyond the neighbours
    step = window[:, None] * (shares[1] - shares[0])
    low, high = np.maximum(best - step, 0.0), np.minimum(best + step, planned.duration)
    for _ in range(_STEPS):
        x, v = curve(best)
        slope = ((places - x) * v).sum(axis=2) - doubt * (best - about)
        best = np.clip(best + slope / ((v**2).sum(axis=2) + doubt), low, high)
    x, v = curve(best)
    which = np.argmin(cost(best, x), axis=1)[:, None]
    weights = (v**2).sum(axis=2) + doubt
    return np.take_along_axis(best, which, axis=1)[:, 0], np.take_along_axis(weights, which, axis=1)[:, 0]
