"""How a run kept to its plan: when in the program each sample was taken, and how far from there the robot was.

A sample's program time comes from how many lines the controller has left: it is good to a segment or two, and a segment of a fast
motion is degrees long. But what is commanded lies on the planned curve: the time is taken where the curve is nearest to it. Where
the curve turns back on itself, it is as near twice; there the samples before and behind decide.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.planned import Planned
from yarclang.robot.model import Array

_LATE = 0.3
"""How far a sample's program time may be off [s], besides the segments: what was asked before it, and a slow link."""

_SEGMENTS = 4.0
"""And how many segments."""

_SURE = 0.12
"""How far a time may be off that the clock has put right [s]."""

_NEAR = 1e-3
"""Two places of the curve whose distances from a sample differ by less than this are equally near [deg or mm]."""

_SAME = 2e-3
"""Times that are nearer to each other are one [s]."""

_DRIFT = 1e-3
"""How much faster than the host's clock the controller's may be; quartzes are ten times better."""

_CANDIDATES = 65
_MINIMA = 3
_STEPS = 5
_ROWS = 2048
"""Samples at once: enough for whole-array work, few enough for memory."""

_DOUBT = 1e-4
"""A time at the end of the window is as bad as this distance [deg or mm]: a few counts decide where nothing moves, and only there."""


@frozen(eq=False)
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
    near = _nearest(planned, units, points, about, window)
    if near.alone.any():
        sure, when = _never_falling(near.times[near.alone], near.weights[near.alone]), clock[near.alone]
        # from one to the next in a straight line; before the first and behind the last as it was told
        inside = np.clip(clock, when[0], when[-1])
        about = np.interp(inside, when, sure) + about - np.interp(inside, clock, about)
    near = _nearest(planned, units, points, about, np.full(len(rows), _SURE))
    return _never_falling(near.times, near.weights), near.times


def _never_falling(values: Array, weights: Array) -> Array:
    """The nearest values that never fall; those with much weight are moved least."""
    from scipy.optimize import isotonic_regression

    result: Array = isotonic_regression(values, weights=weights).x
    return result


@frozen(eq=False)
class _Nearest:
    """When a curve is nearest to points: `times` (M,) [s]; `weights` (M,), how much each of them says, the square of the speed there;
    `alone` (M,), whether the curve isn't as near at another time.
    """

    times: Array
    weights: Array
    alone: NDArray[np.bool_]


def _nearest(planned: Planned, units: Array, points: Array, about: Array, window: Array) -> _Nearest:
    """When the planned curve is nearest to points.

    Args:
        planned: the curve.
        units: (n,) in which distances are measured.
        points: (M, n) [rad or m].
        about: (M,) the times that are looked around [s].
        window: (M,) how far to look [s].
    """
    parts = [slice(first, first + _ROWS) for first in range(0, len(points), _ROWS)]
    found = [_nearest_few(planned, units, points[part], about[part], window[part]) for part in parts]
    return _Nearest(
        np.concatenate([one.times for one in found]),
        np.concatenate([one.weights for one in found]),
        np.concatenate([one.alone for one in found]),
    )


def _nearest_few(planned: Planned, units: Array, points: Array, about: Array, window: Array) -> _Nearest:
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
    final = np.where(np.take_along_axis(is_least, some, axis=1), cost(best, x), np.inf)
    which = np.argmin(final, axis=1)[:, None]
    times = np.take_along_axis(best, which, axis=1)
    # squares add up: another place is as near if its distance is the same but for some counts
    rivals = final < np.take_along_axis(final, which, axis=1) + _NEAR**2
    rivals &= (np.abs(best - times) > _SAME) & (np.abs(best - about) < 2.0 * _SURE)
    weights = np.take_along_axis((v**2).sum(axis=2) + doubt, which, axis=1)
    alone: NDArray[np.bool_] = ~np.any(rivals, axis=1, keepdims=True)
    return _Nearest(times[:, 0], weights[:, 0], alone[:, 0])
