"""Find the speeds that the motions of a chain keep.

The judge (`yarclang.certify`, which checks the compiled controller text independently) proves these speeds.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.motion.chains.flowing.demands import Limits
from yarclang.motion.chains.flowing.means import Sampled
from yarclang.motion.chains.flowing.trial import Trial
from yarclang.motion.chains.flowing.way import Numbers, Way
from yarclang.motion.curve import Curve
from yarclang.motion.framespeed import frame_speeds

_HOLDS = 0.9995
_NEARLY = 0.99
_ABOUT = 0.97
_LESS = 0.01
"""Amount by which a claimed share of speed is reduced, since bounds of a changing speed are less sharp."""
_EDGE = 1e-6
_PARTS = np.array([0.25, 0.5, 0.75])
"""Shares of the time between two samples at which a changing speed is sampled in addition."""
_STEADY = 2e-4
"""Relative change from one sample to the next below which a speed counts as constant."""
_ASIDE = 4
"""Number of samples, half a segment apart, beside a corner whose speeds are kept too."""
_REACHED = 2e-3
"""Share by which a speed may be missed and still counts as reached. It is more than the certificate uses."""


def least_speeds(
    way: Way, limits: Limits, points: Sampled, trial: Trial, segment: float, seams: tuple[bool, bool]
) -> Array:
    """Return the shares (k,) of the requested speeds that the motions keep between their blends.

    If a motion begins at rest or after a slower motion, the share applies once the speed has been reached. If
    it ends at rest or before a slower motion, the share applies until it slows down.

    Args:
        way: the paths of k motions.
        limits: the limits of these motions.
        points: the control points of the motions.
        trial: the result of checking these points.
        segment: the segment time [s].
        seams: two flags: True if the first motion begins at a seam, and True if the last motion ends at
            one.
    """
    times = np.arange(2 * (len(points.points) - 3) + 1, dtype=np.float64) * (0.5 * segment)
    q, rate, _ = Curve(points.points, segment, points.places).sample(times)
    speed = _least_around(way, points, segment, times, frame_speeds(way.paths[0], q, rate))
    knots = segment * trial.ends.astype(np.float64)
    halves = np.concatenate(([0], trial.halves, [0]))
    edges = np.where(
        halves > 0, knots, np.concatenate(([0.0], points.passing(way.begins[1:-1], segment), knots[-1:]))
    )
    # Leave out the blends. At a corner without a blend, include a segment beyond it, since the curve passes
    # the corner slightly before or after the motion profile does.
    aside = np.where(halves > 0, halves - _EDGE, -1.0) * segment
    begin = np.searchsorted(times, edges[:-1] + aside[:-1])
    end = np.searchsorted(times, edges[1:] - aside[1:], side="right")
    is_asked = np.isfinite(limits.speed)
    asked = np.where(is_asked, limits.speed, 1.0)
    share = _least_between(speed, begin, end) / asked
    rests = _rests(limits, halves, seams)
    for place in np.flatnonzero(rests.any(axis=0) & is_asked).tolist():
        speeds = speed[begin[place] : end[place]] / asked[place]
        share[place] = without_dips(speeds, rests[:, place]) if len(speeds) else np.inf
    return np.where(is_asked, np.minimum(claimed_shares(share), 1.0), 1.0)


def claimed_shares(share: Array) -> Array:
    """Return shares of speed (N,) that are a little less than the sampled ones.

    If the speed changes, they are much less, since bounds are less sharp then.
    """
    found: Array = np.where(share > _NEARLY, _HOLDS * share, np.maximum(_ABOUT * share - _LESS, 0.5 * share))
    return found


def _least_between(values: Array, begin: Numbers, end: Numbers) -> Array:
    """Return the least value in each of K ranges of `values`, from index `begin` (K,) up to but not including
    `end` (K,). The result is infinite for empty ranges.
    """
    pairs = np.stack((begin, end), axis=1).ravel()
    least = np.minimum.reduceat(np.append(values, np.inf), pairs)[::2]
    return np.where(end > begin, least, np.inf)


def _rests(limits: Limits, halves: Numbers, seams: tuple[bool, bool]) -> NDArray[np.bool_]:
    """Return two masks (2, K): the motions that begin at rest or after a slower motion, and those that end at
    rest or before a slower motion.

    A slower motion counts only if there is no blend at the corner between the two motions.
    """
    slower = limits.speed[:-1] < limits.speed[1:] * (1.0 - _EDGE)
    faster = limits.speed[1:] < limits.speed[:-1] * (1.0 - _EDGE)
    sharp = halves[1:-1] == 0
    return np.array([[not seams[0], *(sharp & slower)], [*(sharp & faster), not seams[1]]])


def without_dips(speed: Array, rests: NDArray[np.bool_]) -> float:
    """Return the highest level without dips: from the time at which a motion reaches it to the time at which
    the motion slows down, the speed never falls below this level.

    The time begins before the samples if the motion neither begins at rest nor after a slower motion. It ends
    after the samples if the motion neither ends at rest nor before a slower motion. A speed that falls by
    less than the share `_STEADY` isn't a dip.

    Args:
        speed: (N,) the speeds of a motion, as shares of its requested speed.
        rests: two flags: True if the motion begins at rest or after a slower motion, and True if it ends at
            rest or before a slower motion.
    """
    # For each sample, take the largest speed up to it and the largest from it on, each on a side on which the
    # motion rests; `around` is the lower of these two. At a dip, the speed is below `around`.
    around = np.full(len(speed), np.inf)
    least = (1.0 - _STEADY) * float(speed.max())
    if rests[0]:
        around = np.maximum.accumulate(speed)
    if rests[1]:
        around = np.minimum(around, np.maximum.accumulate(speed[::-1])[::-1])
    if not rests.all():
        # The motion keeps its speed at one end: the level is no higher than the speeds beside this end.
        least = float((speed[-_ASIDE - 1 :] if rests[0] else speed[: _ASIDE + 1]).min())
    while True:
        # The motion reaches the claimed speed before it reaches the level, which is higher. A dip in between
        # counts as well.
        reached = around >= (1.0 - _REACHED) * float(claimed_shares(np.array(least)))
        is_dip = speed < (1.0 - _STEADY) * around
        lowest = float(speed[reached & is_dip].min(initial=np.inf))
        if lowest >= least:
            return least
        least = lowest


def _least_around(way: Way, points: Sampled, segment: float, times: Array, speed: Array) -> Array:
    """Return the least speed between each of N times and the next, (N,).

    A changing speed may be lower between two times than at both of them, so it is sampled more closely there.
    """
    least = speed.copy()
    least[:-1] = np.minimum(speed[:-1], speed[1:])
    change = np.abs(np.diff(speed)) > _STEADY * speed[1:]
    change[1:] |= change[:-1].copy()
    change[:-1] |= change[1:].copy()
    (rows,) = np.nonzero(change)
    curve = Curve(points.points, segment, points.places)
    closer = times[rows] + 0.5 * segment * _PARTS[:, None]
    q, rate, _ = curve.sample(closer.ravel())
    speeds = frame_speeds(way.paths[0], q, rate).reshape(closer.shape)
    least[rows] = np.minimum(least[rows], speeds.min(axis=0))
    return least
