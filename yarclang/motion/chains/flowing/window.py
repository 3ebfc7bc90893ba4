"""Plan the motions between two seams of a chain: compute a motion profile and the control points. Where the
control points exceed a limit, slow the profile down and compute them again.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.chains.flowing.demands import Demands, Smoothing
from yarclang.motion.chains.flowing.kept import least_speeds
from yarclang.motion.chains.flowing.law import Law, Pace
from yarclang.motion.chains.flowing.means import Sampled, sampled
from yarclang.motion.chains.flowing.trial import Excess, Trial, tried
from yarclang.motion.chains.flowing.way import Marks, Numbers, Way
from yarclang.progress import go_on

_ROUNDS = 16
_SLOWER = 0.7
"""Exponent of the correction in the first round: the speed is divided by the factor by which a limit is
exceeded, raised to this power.
"""
_MORE = 0.3
"""Amount by which this exponent grows in each round."""
_LEAST = 0.5
"""Least factor by which a speed is reduced in one round."""
_BEYOND = 0.99
"""Additional factor of each reduced speed, so that it is slightly lower than required."""
_SLOWEST = 2e-5
"""Speed below which planning of a window is given up [m/s]."""
_MOST = 0.5
"""Share of the sharpness of all corners near an excess. If the sharpest corner has at least this share, only
this corner is slowed down.
"""
_SAME = 1e-9
_NOTHING = 1e-15
_LITTLE = 1e-7
"""Distance up to which places count as equal [m]."""


@frozen
class Window:
    """The motions of a chain from `first` up to but not including `last`, which are planned together, and the
    speeds at both ends [m/s].

    A speed is 0 at an end at rest; otherwise it is the speed at a seam. The result of a window depends only
    on its motions and a few around them.
    """

    first: int
    last: int
    speeds: tuple[float, float]

    @property
    def seams(self) -> tuple[bool, bool]:
        """Two flags, for the first and the last end of the window: True if the end is a seam."""
        return self.speeds[0] > 0.0, self.speeds[1] > 0.0

    def around(self, way: Way, smoothing: Smoothing) -> tuple[int, int]:
        """Return the range of motions on which the result of the window depends: the first, and the one after
        the last.

        Besides the window's own motions, these are the motions near its seams that both neighbours examine.
        """
        begins, time = way.begins, (smoothing.around + smoothing.reach) * smoothing.segment
        # Length of path that matters beyond each seam, at the seam's constant speed.
        back, ahead = (speed * time * (1.0 + _SAME) + _LITTLE for speed in self.speeds)
        begin, end = begins[self.first] - back, begins[self.last] + ahead
        first, last = self.first, self.last
        if self.seams[0]:
            first = max(0, int(np.searchsorted(begins, begin, side="right")) - 1)
        if self.seams[1]:
            last = min(len(begins) - 1, int(np.searchsorted(begins, end)))
        return first, last


@frozen(eq=False)
class Made:
    """The result of planning a window of k motions.

    `points` (n + 3, d) are the control points. `shares` has the control values of each motion's profile: the
    completed share of the path over time, from the beginning of the blend before the motion to the end of the
    blend after it. `ends` (k + 1,) are the knots at which motions end. `halves` (k + 1,) are half the widths
    of the overlaps at all corners and seams. `least` (k,) are the shares of the requested speeds that the
    motions keep.
    """

    points: Array
    shares: tuple[Array, ...]
    ends: Numbers
    halves: Numbers
    least: Array


@frozen(eq=False)
class Failed:
    """A window that couldn't be planned.

    `seams` has two values, for the first and the last end: True if planning might succeed without the seam
    there.
    """

    seams: tuple[bool, bool]


def made(way: Way, demands: Demands, window: Window, smoothing: Smoothing) -> Made | Failed:
    """Plan a window of a chain, and compute its control points.

    Args:
        way: the paths of the whole chain.
        demands: the limits and corners of the whole chain.
        window: the motions to plan.
        smoothing: the segment time, and the moving averages.
    """
    first, last = window.around(way, smoothing)
    begin, end = window.first - first, window.last - first
    return _Maker(
        way.part(first, last), demands.part(first, last), window.speeds, slice(begin, end), smoothing
    ).made()


@frozen(eq=False)
class _Maker:
    """Planner of one window.

    `way` and `demands` include a few motions beyond the seams; `own` is the range of the window's motions
    among them. `speeds` are the speeds at both ends of the window [m/s].
    """

    way: Way
    demands: Demands
    speeds: tuple[float, float]
    own: slice
    smoothing: Smoothing

    @property
    def seams(self) -> tuple[bool, bool]:
        return self.speeds[0] > 0.0, self.speeds[1] > 0.0

    @property
    def failed(self) -> Failed:
        return Failed(self.seams)

    def made(self) -> Made | Failed:
        """Plan the window: slow its motion profile down until the control points keep all limits."""
        demands, smoothing = self.demands, self.smoothing
        ceiling, slope, rounds = demands.ceilings(smoothing)
        edges = np.concatenate(([0], demands.corners, [len(demands.step)]))
        nodes = slice(int(edges[self.own.start]), int(edges[self.own.stop]) + 1)
        s, ceiling, slope = demands.s[nodes], ceiling[nodes], slope[nodes.start : nodes.stop - 1]
        kept = self._kept(s, ceiling)
        if kept is None:
            return self.failed
        wanted = ceiling[kept]
        for turn in range(_ROUNDS):
            go_on()
            law = Law.fastest(s, ceiling, slope, self.speeds)
            if (np.abs(law.v[kept] - wanted) > _SAME * wanted).any():
                return self.failed
            around = tuple(smoothing.kept * smoothing.segment if seam else 0.0 for seam in self.seams)
            pace = Pace.of(law, self.seams, (around[0], around[1]), smoothing.segment)
            if 2.0 * sum(around) > pace.duration:
                return self.failed
            points = sampled(self.way, pace, smoothing)
            if points is None:
                return Failed((False, False))
            trial = tried(self.way, demands, points, smoothing.segment, rounds, self.own, self._time(pace))
            if trial is None:
                return Failed((False, False))
            if trial.is_good:
                return self._whole(points, trial)
            # A profile that is slowed down at one place passes all later places at other times, where new
            # excesses may occur. The correction therefore grows from round to round.
            steeper = _SLOWER + _MORE * turn
            corner, elsewhere = self._blamed(pace, trial.way, nodes, steeper)
            softer = np.minimum(
                corner,
                np.minimum(self._slower(pace, trial.limits, steeper), self._slower(pace, elsewhere, steeper)),
            )
            ceiling = np.minimum(ceiling * softer, self._allowed(pace, trial.zones))
            slope = slope * np.minimum(softer[1:], softer[:-1])
            if (ceiling[kept] < wanted).any() or ceiling[1:-1].min() < _SLOWEST:
                return self.failed
        return self.failed

    def _kept(self, s: Array, ceiling: Array) -> Marks | None:
        """Set `ceiling` to a seam's speed at all nodes near this seam, and return a mask of the nodes near
        seams (N,).

        The result is None if the ceiling near a seam is lower than its speed, or if the two seams are too
        close to each other.
        """
        kept = np.zeros(len(s), dtype=np.bool_)
        for speed, away in zip(self.speeds, (s - s[0], s[-1] - s), strict=True):
            if speed == 0.0:
                continue
            near = away <= speed * self.smoothing.kept * self.smoothing.segment
            # Include the neighbouring nodes, since otherwise the speed would change between two nodes.
            near[1:] |= near[:-1].copy()
            near[:-1] |= near[1:].copy()
            if (kept & near).any() or (ceiling[near] < speed * (1.0 - _SAME)).any():
                return None
            ceiling[near] = speed
            kept |= near
        return kept

    def _time(self, pace: Pace) -> tuple[float, float]:
        """Return the interval in which excesses must be avoided [s]: the time of the window, and one segment
        beyond each seam.
        """
        h = self.smoothing.segment
        return -h if self.seams[0] else -np.inf, pace.duration + h if self.seams[1] else np.inf

    def _whole(self, points: Sampled, trial: Trial) -> Made | Failed:
        """Return the result for the window's own motions. Cut off what lies beyond its seams."""
        own, h, beyond = self.own, self.smoothing.segment, self.smoothing.around
        # Beyond a seam, the segments belong to the neighbouring window.
        begin, end = (beyond if seam else 0 for seam in self.seams)
        ends = trial.ends[own.start : own.stop + 1] - begin
        count = len(points.points) - 3 - begin - end
        if ends[0] != 0 or ends[-1] != count:
            return self.failed
        halves = np.concatenate(([0], trial.halves, [0]))[own.start : own.stop + 1]
        # A motion profile covers the motion and its blends: n segments have n + 3 control values.
        first, last = begin + ends[:-1] - halves[:-1], begin + ends[1:] + halves[1:] + 3
        edges = np.cumsum(last - first)
        rows = np.repeat(np.arange(own.start, own.stop), last - first)
        knots = np.arange(edges[-1]) + np.repeat(first - np.concatenate(([0], edges[:-1])), last - first)
        gone = (points.places[knots] - self.way.begins[rows]) / self.way.lengths[rows]
        shares = np.split(np.clip(gone, 0.0, 1.0), edges[:-1])
        least = least_speeds(self.way, self.demands.limits, points, trial, h, self.seams)[own]
        return Made(points.points[begin : begin + count + 3], tuple(shares), ends, halves, least)

    def _allowed(self, pace: Pace, excess: Excess) -> Array:
        """Return the largest speeds (N,) at nodes; infinite except near places at which an item is too fast
        in a slow zone.
        """
        law, times = pace.law, pace.by_law(excess.times)
        allowed = np.full(len(law.s), np.inf)
        begin, end = _nodes(law, times, self.smoothing.segment)
        # The speed of the item is proportional to that of the motion profile, so the factor is known exactly.
        speeds = np.maximum(_BEYOND * law.speeds(times) / excess.shares, _SLOWEST)
        for at in np.argsort(-speeds).tolist():
            allowed[begin[at] : end[at]] = np.minimum(allowed[begin[at] : end[at]], speeds[at])
        return allowed

    def _blamed(self, pace: Pace, excess: Excess, nodes: slice, steeper: float) -> tuple[Array, Excess]:
        """For each excess, find the sharpest corner near it, if this corner causes most of the excess.

        Returns:
            Factors (N,) by which the speed limits at these corners are reduced, and the excesses without such
            a corner.
        """
        law, demands = pace.law, self.demands
        factors = np.ones(len(law.s))
        corners = demands.corners[(demands.corners > nodes.start) & (demands.corners < nodes.stop - 1)]
        if not len(corners) or not len(excess.times):
            return factors, excess
        # The less room a corner has for rounding, the sharper it is.
        weight = 1.0 / np.maximum(demands.room()[corners - 1], _NOTHING)
        reach, times = (self.smoothing.reach + 1) * self.smoothing.segment, pace.by_law(excess.times)
        passed = law.t[corners - nodes.start]
        begin, end = np.searchsorted(passed, times - reach), np.searchsorted(passed, times + reach)
        total = np.concatenate(([0.0], np.cumsum(weight)))
        # Find the sharpest corner near each time.
        order = np.argsort(np.argsort(weight))
        pairs = np.stack((begin, end), axis=1).ravel()
        # Find the largest rank in each range. `argsort(weight)` has the corner of each rank.
        worst = np.argsort(weight)[np.maximum.reduceat(np.append(order, 0), pairs)[::2]]
        blamed = (end > begin) & (weight[worst] >= _MOST * (total[end] - total[begin]))
        slower = _BEYOND * np.maximum(excess.shares[blamed] ** -steeper, _LEAST)
        np.minimum.at(factors, corners[worst[blamed]] - nodes.start, slower)
        return factors, Excess(excess.times[~blamed], excess.shares[~blamed])

    def _slower(self, pace: Pace, excess: Excess, steeper: float) -> Array:
        """Return factors (N,) by which the speed limits at nodes are reduced.

        The factor is less than 1 for nodes that affect the pose at a time at which something exceeds its
        limit.
        """
        factors = np.ones(len(pace.law.s))
        if not len(excess.times):
            return factors
        reach = (self.smoothing.reach + 1) * self.smoothing.segment
        begin, end = _nodes(pace.law, pace.by_law(excess.times), reach)
        slower = _BEYOND * np.maximum(excess.shares**-steeper, _LEAST)
        # Apply the strongest reduction last, so that it overwrites weaker ones.
        for at in np.argsort(-slower).tolist():
            factors[begin[at] : end[at]] = slower[at]
        return factors


def _nodes(law: Law, times: Array, reach: float) -> tuple[Numbers, Numbers]:
    """Return for each of N times the range of nodes that a motion profile passes within `reach` [s] of this
    time.

    These are the indices of the first nodes (N,), and of the nodes after the last ones (N,).
    """
    begin = np.maximum(np.searchsorted(law.t, times - reach) - 1, 0)
    return begin, np.minimum(np.searchsorted(law.t, times + reach, side="right") + 1, len(law.s))
