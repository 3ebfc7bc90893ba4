"""Cut a long chain into windows that can be planned independently.

The chain is cut at corners, called seams. The windows before and after a seam pass it at one agreed speed.
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
"""Least number of motions of a window. A window has fewer than twice as many if a suitable corner is
found.
"""
_LONGER = 8
"""Least duration of a window, as a multiple of the time for which the speed is constant at a seam."""
_SLOWEST = 1e-3
"""Least speed at a seam [m/s]."""
_EVEN = 0.7
"""Least ratio of the lowest to the highest speed around a corner for which the corner can be a seam."""
_SLOWER = 0.93
"""Factor by which a seam's speed is reduced if the speed around it changes."""
_FLAT = 1e-9
_ODD = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)


@frozen(eq=False)
class _Corners:
    """The corners (k - 1,) of a chain, rated as possible seams between windows.

    `good` is larger for better corners and 0 for impossible ones. `speed` [m/s] is the speed at which a
    corner is passed if it becomes a seam, and `time` [s] is the time at which the motion profile passes it.
    """

    good: Array
    speed: Array
    time: Array


def windows(way: Way, demands: Demands, smoothing: Smoothing) -> list[Window]:
    """Cut a chain into windows, at the best corners.

    The choice of a corner depends only on its surroundings. A change of one motion therefore moves only the
    nearest seams.
    """
    count = len(way.paths)
    if count < 2 * SHORTEST:
        return [Window(0, count, (0.0, 0.0))]
    ceiling, slope, rounds = demands.ceilings(smoothing)
    law = Law.fastest(demands.s, ceiling, slope)
    corners = _looked_at(way, demands, law, smoothing, rounds)
    cut, begin, speed = [], 0, 0.0
    least = _LONGER * smoothing.kept * smoothing.segment
    time = 0.0
    while True:
        # Motion c + 1 begins at corner number c.
        first = max(begin + SHORTEST, int(np.searchsorted(corners.time, time + least)) + 1)
        last = min(first + SHORTEST, count - SHORTEST)
        near = slice(first - 1, max(last - 1, first - 1))
        if near.start == near.stop or law.duration - corners.time[near.start] < least:
            break
        best = near.start + int(np.argmax(corners.good[near]))
        if corners.good[best] == 0.0:
            # No good corner is near: extend the window.
            later = np.flatnonzero(corners.good[near.stop : count - SHORTEST - 1])
            if not len(later):
                break
            best = near.stop + int(later[0])
        seam, faster = best + 1, float(corners.speed[best])
        cut.append(Window(begin, seam, (speed, faster)))
        begin, speed, time = seam, faster, float(corners.time[best])
    cut.append(Window(begin, count, (speed, 0.0)))
    return cut


def merged(cut: list[Window], failed: list[bool], reach: int) -> list[Window]:
    """Merge each failed window with `reach` neighbours on either side, and return all windows.

    An item of `failed` is also True if the window doesn't match the next one at their common seam.
    """
    together = np.zeros(len(cut) - 1, dtype=np.bool_)
    for place in np.flatnonzero(failed).tolist():
        together[max(0, place - reach) : place + reach] = True
    result = [cut[0]]
    for window, joined in zip(cut[1:], together.tolist(), strict=True):
        if joined:
            before = result.pop()
            result.append(Window(before.first, window.last, (before.speeds[0], window.speeds[1])))
        else:
            result.append(window)
    return result


def _looked_at(way: Way, demands: Demands, law: Law, smoothing: Smoothing, rounds: Marks) -> _Corners:
    """Rate the corners of a chain as possible seams."""
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
    but not including `end` (K,).
    """
    pairs = np.stack((begin, end), axis=1).ravel()
    return np.minimum.reduceat(values, pairs)[::2], np.maximum.reduceat(values, pairs)[::2]


def _rounded(values: Array, digits: int) -> Array:
    """Return values rounded to a number of significant digits."""
    size = 10.0 ** (digits - 1 - np.floor(np.log10(np.maximum(values, _FLAT))))
    found: Array = np.round(values * size) / size
    return found


def _scattered(points: Array) -> Array:
    """Return a pseudorandom number from 0 to 1 for each point (K, 3). It depends only on the point."""
    bits = np.ascontiguousarray(points).view(np.uint64)
    # Multiply and xorshift the bits of the coordinates; the highest 53 bits are the fraction of a float64.
    mixed = (bits * _ODD).sum(axis=1, dtype=np.uint64)
    mixed ^= mixed >> np.uint64(29)
    mixed *= _ODD[1]
    found: Array = (mixed >> np.uint64(11)).astype(np.float64) * 2.0**-53
    return found
