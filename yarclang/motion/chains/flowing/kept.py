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
"""Reduction of a claimed share of speed: a changing speed can't be proved as sharply as a constant one."""
_EDGE = 1e-6
_PARTS = np.array([0.25, 0.5, 0.75])
"""Places between two times that are sampled in addition."""
_STEADY = 2e-4
"""Share of change from one time to the next below which a speed counts as constant."""
_ASIDE = 4
"""Number of half segments from a corner within which a speed counts as reached."""


def least_speeds(
    way: Way, limits: Limits, points: Sampled, trial: Trial, segment: float, seams: tuple[bool, bool]
) -> Array:
    """Return the shares of the requested speeds (k,) below which the motions don't fall between their blends.

    For a motion that begins or ends at rest, or beside a slower motion, the share applies after the speed has
    been reached.

    Args:
        way: the paths of k motions.
        limits: the limits of these motions.
        points: the control points of the motions.
        trial: the result of checking these points.
        segment: the segment time [s].
        seams: two values: whether the first motion begins at a seam, and whether the last ends at one.
    """
    times = np.arange(2 * (len(points.points) - 3) + 1, dtype=np.float64) * (0.5 * segment)
    q, rate, _ = Curve(points.points, segment, points.places).sample(times)
    speed = _least_around(way, points, segment, times, frame_speeds(way.paths[0], q, rate))
    knots = segment * trial.ends.astype(np.float64)
    halves = np.concatenate(([0], trial.halves, [0]))
    edges = np.where(
        halves > 0, knots, np.concatenate(([0.0], points.passing(way.begins[1:-1], segment), knots[-1:]))
    )
    # The curve passes a corner slightly before or after the law does.
    aside = np.where(halves > 0, halves - _EDGE, -1.0) * segment
    begin = np.searchsorted(times, edges[:-1] + aside[:-1])
    end = np.searchsorted(times, edges[1:] - aside[1:], side="right")
    is_asked = np.isfinite(limits.speed)
    asked = np.where(is_asked, limits.speed, 1.0)
    share = _least_between(speed, begin, end) / asked
    rests = _rests(limits, halves, seams)
    for place in np.flatnonzero(rests.any(axis=0) & is_asked).tolist():
        own = speed[begin[place] : end[place]]
        if rests[:, place].all():
            own = _without_dips(own)
        elif rests[0, place]:
            own = np.minimum.accumulate(own[::-1])[_ASIDE:]
        else:
            own = np.minimum.accumulate(own)[_ASIDE:]
        share[place] = own.max() / asked[place] if len(own) else np.inf
    claimed = np.where(share > _NEARLY, _HOLDS * share, np.maximum(_ABOUT * share - _LESS, 0.5 * share))
    return np.where(is_asked, np.minimum(claimed, 1.0), 1.0)


def _least_between(values: Array, begin: Numbers, end: Numbers) -> Array:
    """Return the least value in each of K ranges of `values`, from index `begin` (K,) up to `end` (K,);
    infinite for empty ranges.
    """
    pairs = np.stack((begin, end), axis=1).ravel()
    least = np.minimum.reduceat(np.append(values, np.inf), pairs)[::2]
    return np.where(end > begin, least, np.inf)


def _rests(limits: Limits, halves: Numbers, seams: tuple[bool, bool]) -> NDArray[np.bool_]:
    """Return two masks (2, K): the motions that begin at rest or after a slower motion, and those that end at
    rest or before a slower motion.

    A slower motion counts only if there is no blend between the two.
    """
    slower = limits.speed[:-1] < limits.speed[1:] * (1.0 - _EDGE)
    faster = limits.speed[1:] < limits.speed[:-1] * (1.0 - _EDGE)
    sharp = halves[1:-1] == 0
    return np.array([[not seams[0], *(sharp & slower)], [*(sharp & faster), not seams[1]]])


def _without_dips(speed: Array) -> Array:
    """Return the speeds (N,), limited to a level below which they don't fall once it is reached.

    Between two places that reach the level, no speed is below it.
    """
    around = np.minimum(np.maximum.accumulate(speed), np.maximum.accumulate(speed[::-1])[::-1])
    least, dips = np.inf, np.inf
    top = (1.0 - _STEADY) * speed.max(initial=0.0)
    while dips < least or least == np.inf:
        least = min(top, dips)
        dips = speed[(speed < around) & (around >= least)].min(initial=least)
    return np.minimum(speed, least)


def _least_around(way: Way, points: Sampled, segment: float, times: Array, speed: Array) -> Array:
    """Return the least speed between each of N times and the next, (N,).

    If the speed changes, it may be lower between two times than at both of them, so it is sampled in between.
    """
    found = speed.copy()
    found[:-1] = np.minimum(speed[:-1], speed[1:])
    change = np.abs(np.diff(speed)) > _STEADY * speed[1:]
    change[1:] |= change[:-1].copy()
    change[:-1] |= change[1:].copy()
    (rows,) = np.nonzero(change)
    curve = Curve(points.points, segment, points.places)
    closer = times[rows] + 0.5 * segment * _PARTS[:, None]
    q, rate, _ = curve.sample(closer.ravel())
    speeds = frame_speeds(way.paths[0], q, rate).reshape(closer.shape)
    found[rows] = np.minimum(found[rows], speeds.min(axis=0))
    return found
