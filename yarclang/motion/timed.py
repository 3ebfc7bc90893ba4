"""Fit the path of a timetable to the controller's segments.

The path is a function of time, so only the segments and the curve's smoothness can be chosen. If the
acceleration of the path jumps, as it does at both ends of a clamped spline, a curve through all knots
overshoots. The control points therefore minimize a weighted sum of squares: of the distances at the knots,
and of the differences between the accelerations of curve and path. With a larger weight of the accelerations,
the curve overshoots less and is farther from the path. The largest weight that keeps the tolerance is used.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.curve import FEWEST_SEGMENTS, Curve, knot_values
from yarclang.motion.fit import MOST_SEGMENTS, TooLong
from yarclang.motion.limits import Bounds, Demand, Grid
from yarclang.motion.paths.timed import TimedPath
from yarclang.progress import go_on
from yarclang.units import MS

LATE = 1.0 * MS
"""Time by which a motion may last longer than its timetable [s], since the controller's segment times have
steps.
"""

_SHARE = 0.85
"""Share of the tolerance that is used, since the distance is sampled only at some places."""

_BETWEEN = 4
"""Number of samples in each segment."""

_WEIGHTS = (1e6, 1e5, 1e4, 1e3, 1e2, 1e1, 1.0, 0.1, 0.0)
"""Weights to try for the differences of accelerations."""

_GAIN = 0.98
"""Factor by which shorter segments must reduce an excess; otherwise still shorter ones aren't tried."""

_FINER = 0.6
"""Factor by which segments become shorter from one attempt to the next, if limits are broken or the curve
overshoots.
"""

_OVERSHOOT = 1.15
"""Overshoot above which shorter segments are tried: the ratio of the curve's largest acceleration to that of
the path, or to half of the limit if this is larger.
"""

_ROUNDS = 12


@frozen
class Broken:
    """A limit that a timetable breaks; `demand` names the limit.

    `share` is the required multiple of the limit (1 is exactly the limit), and `time` [s] is when the limit
    is broken.
    """

    demand: Demand
    share: float
    time: float


@frozen
class Missed:
    """A path that can't be followed within the tolerance: at the time `time` [s] after the start, `joint` is
    off by `off` [rad or m].

    This error remains with the shortest segments, of `segment` [s]. `share` is the error as a multiple of the
    tolerance.
    """

    joint: int
    off: float
    time: float
    segment: float
    share: float


@frozen
class TooShort:
    """A timetable that is too short for the fewest segments that a motion may have.

    The table ends after `duration` [s], and the fewest segments take `shortest` [s].
    """

    duration: float
    shortest: float


Refused = Broken | Missed | TooShort
"""The reasons why a timetable can't be executed as it is. The timetable can be executed if all its times are
multiplied by a large enough factor.
"""


def fit_timed(path: TimedPath, within: Array, bounds: Bounds, grid: Grid) -> Curve | Refused | TooLong:
    """Choose the segments and the control points of a motion along a timetable.

    Args:
        path: the joint positions over time.
        within: (n,) the tolerance: the largest distance of each joint from its position at the same time [rad
            or m].
        bounds: the limits to keep, except that on jerk, since the table determines the jerk.
        grid: the segment times that the controller accepts.

    Returns:
        The curve, which lasts as long as the table or up to `LATE` longer; or the reason why there is none.
    """
    bounds = bounds.without_jerk()
    wanted = min(grid.largest, path.duration / FEWEST_SEGMENTS)
    if FEWEST_SEGMENTS * grid.smallest > path.duration + LATE:
        return TooShort(path.duration, FEWEST_SEGMENTS * grid.smallest)
    broken: Broken | None = None
    best: tuple[float, Curve] | None = None
    for _ in range(_ROUNDS):
        go_on()
        segments, segment = _divided(path.duration, wanted, grid)
        if segments > MOST_SEGMENTS:
            break
        is_last = (
            wanted <= grid.smallest * (1.0 + 1e-9) or (segments + 1) * grid.smallest > path.duration + LATE
        )
        trial = _Trial.of(path, within, segments)
        points, excess = trial.solved(0.0)
        if excess > _SHARE:
            if is_last:
                # Not even the shortest segments can follow the table: report the limit that the motion breaks
                # by most.
                demand = max(bounds.demands(points), key=lambda one: one.segment)
                refusal = _broken(demand, segment) if demand.segment > segment else None
                return broken or refusal or trial.missed(points, segment)
            # If the acceleration jumps, the error is proportional to the square of the segment time.
            wanted = max(grid.smallest, segment * max(0.3, min(0.9, 0.95 * math.sqrt(_SHARE / excess))))
            continue
        points = trial.smoothest(points)
        demand = max(bounds.demands(points), key=lambda one: one.segment)
        if demand.segment <= segment:
            points.setflags(write=False)
            curve = Curve(points, segment, np.clip((np.arange(segments + 3) - 1.0) / segments, 0.0, 1.0))
            over = trial.overshoot(curve, bounds)
            is_better = best is None or over < _GAIN * best[0]
            best = (over, curve) if is_better else best
            if over <= _OVERSHOOT:
                break
        else:
            refusal = _broken(demand, segment)
            is_better = broken is None or refusal.share < 1.0 + _GAIN * (broken.share - 1.0)
            if broken is None or refusal.share < broken.share:
                broken = refusal
        if is_last or not is_better:
            break
        wanted = max(grid.smallest, segment * _FINER)
    return best[1] if best is not None else broken or TooLong(path.duration)


STEPS = 24
"""Largest number of factors that the search for the smallest factor tries."""

FINE = 1.001
"""The search for the smallest factor ends when the smallest factor that has worked is at most this many times
the largest factor that has failed.
"""


def shortest_stretch(
    path_at: Callable[[float], TimedPath],
    refused: Refused,
    within: Array,
    bounds: Bounds,
    grid: Grid,
    stretch: float,
) -> float | None:
    """Search for the smallest factor by which all times of a timetable must be multiplied to keep all limits.

    Args:
        path_at: function that returns the path with all times multiplied by a factor.
        refused: the reason why the factor `stretch` doesn't work.
        within: as for `fit_timed`.
        bounds: as for `fit_timed`.
        grid: as for `fit_timed`.
        stretch: a factor that doesn't work.

    Returns:
        A factor with few digits that was tried and works; None if none is found.
    """
    fails, works = stretch, math.inf
    nearest = stretch * _needed(refused)
    for _ in range(STEPS):
        tried = _few_digits(nearest)
        if tried >= works or tried <= fails:
            break
        fitted = fit_timed(path_at(tried), within, bounds, grid)
        if isinstance(fitted, TooLong):
            break
        if isinstance(fitted, Curve):
            works = tried
        else:
            fails = tried
        if not isinstance(fitted, Curve) and math.isinf(works):
            # Until a factor works, follow the estimate. Then bisect, by the geometric mean.
            nearest = tried * max(_needed(fitted), FINE)
        elif works <= fails * FINE:
            break
        else:
            nearest = math.sqrt(fails * works)
    return works if math.isfinite(works) else None


def _needed(refused: Refused) -> float:
    """Return the approximate factor by which all times of a timetable must be multiplied.

    Velocities are inversely proportional to the factor. Accelerations are inversely proportional to its
    square, and so is the path error that remains with the shortest possible segments.
    """
    if isinstance(refused, TooShort):
        return refused.shortest / refused.duration
    if isinstance(refused, Missed):
        return math.sqrt(refused.share / _SHARE)
    return float(refused.share ** (1.0 / _ORDERS[refused.demand.kind]))


def _few_digits(stretch: float) -> float:
    """Return a factor with four digits that isn't below the given one."""
    digits = 3 - math.floor(math.log10(stretch))
    return round(math.ceil(stretch * 10.0**digits - 1e-6) / 10.0**digits, max(0, digits))


_ORDERS = {"velocity": 1, "motor speed": 1, "zone speed": 1, "acceleration": 2, "jerk": 3}
"""The order of the time derivative that each limit concerns."""


def _broken(demand: Demand, segment: float) -> Broken:
    order = _ORDERS[demand.kind]
    # A difference of order r from control point i on belongs to knot i + r/2 - 1, since control points are
    # one knot ahead.
    middle = demand.at + (order - 2) / 2.0
    return Broken(demand, (demand.segment / segment) ** order, max(0.0, middle * segment))


_NUMBERS = 4096
"""Largest number of candidates for the number of segments that are compared: above the wanted number, and
also below it.
"""


def _divided(duration: float, wanted: float, grid: Grid) -> tuple[int, float]:
    """Return a number of segments and a segment time [s] near `wanted`. Together they last as long as a
    timetable, or longer by at most `LATE` if possible.
    """
    steps = duration / grid.quantum
    most = max(FEWEST_SEGMENTS, math.floor((duration + LATE) / grid.smallest + 1e-9))
    least = min(most, max(FEWEST_SEGMENTS, math.ceil(duration / wanted - 1e-9)))
    fewest = max(FEWEST_SEGMENTS, math.ceil(duration / grid.largest - 1e-9))
    # Try some thousand numbers, the larger ones first. For a long motion, about one in twenty has a segment
    # time that the controller's steps allow.
    larger = np.arange(least, min(most, least + _NUMBERS) + 1)
    smaller = np.arange(least - 1, max(fewest, least - _NUMBERS) - 1, -1)
    numbers = np.concatenate((larger, smaller))
    # Round segment times up to whole steps of the controller, so that the motion is never shorter than the
    # table.
    each = np.ceil(steps / numbers - 1e-9)
    each = np.maximum(each, math.ceil(grid.smallest / grid.quantum - 1e-6))
    late = (each * numbers - steps) * grid.quantum
    place = int(np.argmax(late <= LATE)) if (late <= LATE).any() else int(np.argmin(late))
    return int(numbers[place]), float(each[place] * grid.quantum)


@frozen(eq=False)
class _Trial:
    """A fit of a timetable with a fixed number n of segments.

    `knots` (n + 1, d) are the wanted joint positions at the knots, `between` (n * _BETWEEN + 1, d) those at
    all samples. `within` (d,) is the tolerance.
    """

    path: TimedPath
    within: Array
    knots: Array
    between: Array

    @staticmethod
    def of(path: TimedPath, within: Array, segments: int) -> _Trial:
        """Sample the joint positions that a timetable prescribes."""
        count = segments * _BETWEEN
        between = path.joints(np.arange(count + 1) / count)
        return _Trial(path, within, between[::_BETWEEN], between)

    def solved(self, weight: float) -> tuple[Array, float]:
        """Return the control points (n + 3, d) that fit the path, and the share of the tolerance that they
        use. `weight` is the weight of the accelerations.
        """
        points = _least_squares(self.knots, weight)
        return points, float((np.abs(_looked_at(points) - self.between) / self.within).max())

    def smoothest(self, points: Array) -> Array:
        """Return the control points for the largest weight of the accelerations that keeps the tolerance.

        Args:
            points: the control points for the weight 0, which are returned if no larger weight keeps the
                tolerance.
        """
        low, high = 0, len(_WEIGHTS) - 1
        while low < high:
            middle = (low + high) // 2
            found, excess = self.solved(_WEIGHTS[middle])
            if excess <= _SHARE:
                points, high = found, middle
            else:
                low = middle + 1
        return points

    def overshoot(self, curve: Curve, bounds: Bounds) -> float:
        """Return the ratio of a curve's largest acceleration to that of the path, or to half of the limit if
        that is larger.
        """
        asked = np.abs(np.diff(self.knots, 2, axis=0)).max(axis=0) / curve.segment**2
        made = np.abs(np.diff(curve.points, 2, axis=0)).max(axis=0) / curve.segment**2
        return float((made / np.maximum(asked, bounds.acceleration / 2.0)).max())

    def missed(self, points: Array, segment: float) -> Missed:
        """Return the largest error of control points, in relation to the tolerance, with its joint and
        time.
        """
        off = np.abs(_looked_at(points) - self.between)
        at, joint = divmod(int(np.argmax(off / self.within)), off.shape[1])
        most = float(off[at, joint])
        return Missed(joint, most, at / _BETWEEN * segment, segment, most / float(self.within[joint]))


def _looked_at(points: Array) -> Array:
    """Return the joint positions (n * _BETWEEN + 1, d) at the knots and between them, for control points
    (n + 3, d).
    """
    f = [points[i : len(points) - 3 + i] for i in range(4)]
    positions = np.empty((len(f[0]) * _BETWEEN + 1, points.shape[1]))
    for place in range(_BETWEEN):
        u = place / _BETWEEN
        # Basis functions of the uniform cubic B-spline at the share u of a segment, times 6.
        w = 1.0 - u
        shares = w**3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3
        positions[place:-1:_BETWEEN] = sum(share * one for share, one in zip(shares, f, strict=True)) / 6.0
    positions[-1] = knot_values(points[-3:])[0]
    return positions


def _least_squares(knots: Array, weight: float) -> Array:
    """Return the control points (n + 3, d) that fit joint positions at knots 0 to n, (n + 1, d), by least
    squares.

    The first three control points are the start and the last three the end. Each knot from 1 to n - 1 gives
    two equations: one for the position, and one for the second difference, multiplied by the root of
    `weight`. Each unknown occurs in three equations of either kind, so that the normal equations have the
    same coefficients in every row.
    """
    from scipy.linalg import solveh_banded

    start, end = knots[0], knots[-1]
    points = np.concatenate(
        (np.tile(start, (3, 1)), np.zeros((len(knots) - 4, knots.shape[1])), np.tile(end, (3, 1)))
    )
    inner = slice(1, -1)
    positions = knots[inner] - knot_values(points)[inner]
    bends = np.diff(knots, 2, axis=0) - np.diff(points, 2, axis=0)[inner]
    # Normal equations A'A + weight B'B: A has the rows (1, 4, 1) / 6 of the positions, and B has the rows (1,
    # -2, 1) of the second differences. Both products have five diagonals.
    right = (positions[:-2] + 4.0 * positions[1:-1] + positions[2:]) / 6.0
    right += weight * np.diff(bends, 2, axis=0)
    unknowns = len(right)
    rows = np.array([1.0, 8.0, 18.0]) / 36.0 + weight * np.array([1.0, -4.0, 6.0])
    if unknowns < 3:
        full = sum(
            (np.diag(np.full(unknowns - abs(i), rows[2 - abs(i)]), i) for i in range(1 - unknowns, unknowns)),
            start=np.zeros((unknowns, unknowns)),
        )
        points[3:-3] = np.linalg.solve(full, right)
        return points
    band = np.repeat(rows[:, None], unknowns, axis=1)
    points[3:-3] = solveh_banded(band, right, check_finite=False)
    return points
