"""Shorten joint-space polylines in time: the measure is the time that joints need at their speed limits, not
the distance that bodies travel.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.hir import Array
from yarclang.motion.natural import NaturalSpline
from yarclang.progress import go_on
from yarclang.robot.model import Limits

TRIES = 200
"""Number of shortcuts that are tried."""

_LEAST = 0.005
"""Least share of the whole polyline's time that a shortcut must save. A shortcut that saves less isn't
checked for collisions.
"""

_PLACES = 201


def duration(curve: NaturalSpline, limits: Limits) -> float:
    """Estimate the duration [s] of the motion along a curve from rest to rest, within the limits of velocity
    and acceleration.

    The estimate assumes a motion profile that is a polynomial of degree 5.
    """
    u = np.linspace(0.0, 1.0, _PLACES)[:, None]
    # First and second derivative of s(u) = u^3 (10 - 15 u + 6 u^2). By the chain rule, q' = y' s' and q'' =
    # y'' s'^2 + y' s''; a duration T divides them by T and T^2.
    rate, change = 30.0 * u**2 * (1.0 - u) ** 2, 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)
    s = (u**3 * (10.0 - 15.0 * u + 6.0 * u**2))[:, 0]
    slope = curve.slope_at(s)
    bend = np.column_stack([np.interp(s, curve.knots, one) for one in curve.bends.T])
    # A duration T needs |q'| / T <= velocity and |q''| / T^2 <= acceleration at every u.
    by_velocity = float((np.abs(slope) * rate / limits.velocity).max())
    by_acceleration = float((np.abs(bend * rate**2 + slope * change) / limits.acceleration).max())
    return max(by_velocity, float(np.sqrt(by_acceleration)))


def shortened(
    corners: Array, free: Callable[[Array], bool], step: Array, velocity: Array, seed: int
) -> Array:
    """Shorten a joint-space polyline in time, at the joints' largest speeds. Start and end don't change.

    Random parts of the polyline are replaced by straight segments, of all joints or of one joint alone, if
    this saves time and is free of collisions.

    Args:
        corners: (w, n) the corners [rad or m] of a polyline that is free of collisions.
        free: function that returns True if a joint position (n,) is free.
        step: (n,) distance between joint positions that are checked [rad or m].
        velocity: (n,) the joints' largest speeds [rad/s or m/s].
        seed: seed of the random choices.

    Returns:
        The corners of the shortened polyline (k, n) [rad or m].
    """
    random = np.random.default_rng(seed)
    points = corners
    for _ in range(TRIES):
        if len(points) < 3:
            break
        go_on()
        length = _length(points, velocity)
        whole = float(length[-1])
        first, last = np.sort(random.random(2)) * whole
        joint = int(random.integers(-1, len(velocity)))
        candidate, begin, end = _cut(points, length, float(first), float(last), joint)
        if _length(candidate, velocity)[-1] > whole * (1.0 - _LEAST):
            continue
        if all(
            _is_free(one, other, free, step)
            for one, other in zip(candidate[begin:end], candidate[begin + 1 : end + 1], strict=True)
        ):
            points = _without_idle(candidate, velocity)
    return points


def _length(points: Array, velocity: Array) -> Array:
    """Return the time from the start of a polyline to each corner, (k,) [s].

    The time of a segment is that of its slowest joint, plus a small share of the times of all joints.
    """
    legs = np.abs(np.diff(points, axis=0)) / velocity
    taken = legs.max(axis=1) + _ALL * np.linalg.norm(legs, axis=1)
    return np.concatenate(([0.0], np.cumsum(taken)))


_ALL = 0.1
"""Weight of the norm of all joints' times, which is added to the time of the slowest joint. Without it, the
other joints could move to and fro at no cost.
"""


def _cut(points: Array, length: Array, first: float, last: float, joint: int) -> tuple[Array, int, int]:
    """Return the polyline with a straight segment between two places on it, and the first and the last index
    of the new corners.

    Args:
        points: the corners of the polyline.
        length: the time from the start to each corner [s].
        first: the place where the segment begins, as a time from the start [s].
        last: the place where the segment ends, as a time from the start [s].
        joint: index of the only joint that is interpolated linearly over the segment; -1 for all joints.
    """
    # Interpolate the two places, each between its neighbouring corners, in time.
    legs = np.searchsorted(length, [first, last], side="right") - 1
    legs = np.minimum(legs, len(points) - 2)
    shares = (np.array([first, last]) - length[legs]) / np.maximum(np.diff(length)[legs], 1e-12)
    start, stop = points[legs] + shares[:, None] * (points[legs + 1] - points[legs])
    middles = points[legs[0] + 1 : legs[1] + 1].copy()
    if joint < 0:
        middles = middles[:0]
    elif len(middles):
        # Only one joint is interpolated linearly: replace its coordinate at the corners in between.
        share = (length[legs[0] + 1 : legs[1] + 1] - first) / max(last - first, 1e-12)
        middles[:, joint] = start[joint] + share * (stop[joint] - start[joint])
    found = np.concatenate((points[: legs[0] + 1], start[None], middles, stop[None], points[legs[1] + 1 :]))
    begin = int(legs[0]) + 1
    return found, begin, begin + len(middles) + 1


def _is_free(one: Array, other: Array, free: Callable[[Array], bool], step: Array) -> bool:
    """Return True if the straight segment between two joint positions is free of collisions; its middle is
    checked first.
    """
    count = max(int(np.ceil(np.linalg.norm((other - one) / step))), 1)
    order = _by_halves(count)
    return all(free(q) for q in one + (order / count)[:, None] * (other - one))


def _by_halves(count: int) -> Array:
    """Return the integers from 0 to `count` in an order that finds an obstruction early.

    Each integer is as far as possible from all integers before it.
    """
    places = np.arange(count + 1)
    # Odd multiples of decreasing powers of two: the middle, the quarters, the eighths, and so on.
    stride = 1 << int(np.ceil(np.log2(count + 1)))
    found = []
    while stride:
        found.append(places[stride :: 2 * stride] if stride <= count else places[:1])
        stride //= 2
    return np.concatenate(found).astype(float)


def _without_idle(points: Array, velocity: Array) -> Array:
    """Return the polyline without corners that coincide with others or lie on a straight line."""
    kept = [points[0]]
    for at in range(1, len(points) - 1):
        before, here, after = kept[-1], points[at], points[at + 1]
        into, on = (here - before) / velocity, (after - here) / velocity
        a, b = float(np.linalg.norm(into)), float(np.linalg.norm(on))
        if a > _SAME and b > _SAME and float(np.linalg.norm(into / a - on / b)) > _SAME:
            kept.append(here)
    return np.array([*kept, points[-1]])


_SAME = 1e-6
"""Distance between two corners [s] below which one is dropped, and change of direction (difference of unit
vectors) below which a corner counts as straight.
"""
