"""Cut a long chain into windows that can be planned independently.

The cuts ("seams") are at corners that the windows on both sides pass at the same speed.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.chains.flowing.demands import Demands, Smoothing
from yarclang.motion.chains.flowing.law import Law
from yarclang.motion.chains.flowing.way import Marks, Numbers, Way
from yarclang.motion.chains.flowing.window import Window

SHORTEST = 128
"""Least number of motions of a window. A window has less than twice as many if a seam is found."""
_LONGER = 8
"""Least duration of a window, as a multiple of the time for which the speed is kept at a seam."""
_SLOWEST = 1e-3
"""Least speed at a seam [m/s]."""
_EVEN = 0.7
"""Least ratio of a seam's speed to the largest speed around it."""
_SLOWER = 0.93
"""Factor by which a seam's speed is reduced if the speed around it changes."""
_FLAT = 1e-9
_ODD = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)


@frozen(eq=False)
class _Corners:
    """The corners (k - 1,) of a chain, rated as seams between windows.

    `good` is larger for better corners and 0 for impossible ones. `speed` [m/s] and `time` [s] say how fast
    and when a corner is passed.
    """

    good: Array
    speed: Array
    time: Array


def windows(way: Way, demands: Demands, smoothing: Smoothing) -> list[Window]:
    """Cut a chain into windows, at good seams.

    The choice of a seam depends only on its surroundings, so that a change of one motion moves only the
    nearest seams.
    """
    count = len(way.paths)
    if count < 2 * SHORTEST:
        return [Window(0, count, (0.0, 0.0))]
    ceiling, slope, rounds = demands.ceilings(smoothing)
    law = Law.fastest(demands.s, ceiling, slope)
    corners = _looked_at(way, demands, law, smoothing, rounds)
    found, begin, speed = [], 0, 0.0
    least = _LONGER * smoothing.kept * smoothing.segment
    time = 0.0
    while True:
        # Motion c + 1 begins at corner number c.
        first = max(begin + SHORTEST, int(np.searchsorted(corners.time, time + least)) + 1)
        last = min(first + SHORTEST, count - SHORTEST)
        own = slice(first - 1, max(last - 1, first - 1))
        if own.start == own.stop or law.duration - corners.time[own.start] < least:
            break
        best = own.start + int(np.argmax(corners.good[own]))
        if corners.good[best] == 0.0:
            # No good corner is near: extend the window.
            later = np.flatnonzero(corners.good[own.stop : count - SHORTEST - 1])
            if not len(later):
                break
            best = own.stop + int(later[0])
        seam, faster = best + 1, float(corners.speed[best])
        found.append(Window(begin, seam, (speed, faster)))
        begin, speed, time = seam, faster, float(corners.time[best])
    found.append(Window(begin, count, (speed, 0.0)))
    return found


def merged(cut: list[Window], failed: list[bool], reach: int) -> list[Window]:
    """Merge each failed window with `reach` neighbours on either side, and return all windows.

    An item of `failed` is also True if the window doesn't match the next one at their common seam.
    """
    together = np.zeros(len(cut) - 1, dtype=np.bool_)
    for place in np.flatnonzero(failed).tolist():
        together[max(0, place - reach) : place + reach] = True
    found = [cut[0]]
    for window, joined in zip(cut[1:], together.tolist(), strict=True):
        if joined:
            before = found.pop()
            found.append(Window(before.first, window.last, (before.speeds[0], window.speeds[1])))
        else:
            found.append(window)
    return found


def _looked_at(way: Way, demands: Demands, law: Law, smoothing: Smoothing, rounds: Marks) -> _Corners:
    """Rate the corners as seams."""
    at = demands.corners
    time = law.t[at]
    around = (smoothing.kept + smoothing.reach) * smoothing.segment
    begin = np.maximum(np.searchsorted(law.t, time - around) - 1, 0)
    end = np.minimum(np.searchsorted(law.t, time + around, side="right") + 1, len(law.t) - 1)
    low, high = _extremes(law.v, begin, end)
    flat = low >= high * (1.0 - _FLAT)
    speed = np.where(flat, _rounded(low, 10), _rounded(_SLOWER * low, 3))
    # Prefer corners at constant speed, then corners where the path is kept. A pseudorandom number that
    # depends only on the corner's place decides a tie.
    good = 4.0 * flat + 2.0 * ~rounds + 1.0 + _scattered(way.start[1:])
    good[(low < _EVEN * high) | (speed < _SLOWEST)] = 0.0
    return _Corners(good, speed, time)


def _extremes(values: Array, begin: Numbers, end: Numbers) -> tuple[Array, Array]:
    """Return the least and the largest value in each of K ranges of `values`, from index `begin` (K,) up to
    `end` (K,).
    """
    pairs = np.stack((begin, end), axis=1).ravel()
    return np.minimum.reduceat(values, pairs)[::2], np.maximum.reduceat(values, pairs)[::2]


def _rounded(values: Array, digits: int) -> Array:
    """Return values rounded to a number of significant digits."""
    size = 10.0 ** (digits - 1 - np.floor(np.log10(np.maximum(values, _FLAT))))
    found: Array = np.round(values * size) / size
    return found


def _scattered(points: Array) -> Array:
    """Return a pseudorandom number from 0 to 1 for each point (K, 3), always the same for the same point."""
    bits = np.ascontiguousarray(points).view(np.uint64)
    mixed = (bits * _ODD).sum(axis=1, dtype=np.uint64)
    mixed ^= mixed >> np.uint64(29)
    mixed *= _ODD[1]
    found: Array = (mixed >> np.uint64(11)).astype(np.float64) * 2.0**-53
    return found
