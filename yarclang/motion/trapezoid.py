"""Laws that speed up, cruise and slow down, with accelerations that rise and fall in ramps of whole segments.

A form is (blend, ramp): the segments of speeding up (and of slowing down), and of each of its two ramps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array

FEWEST_IN_BLEND = 2
"""A blend is two ramps of one segment at least."""

_ROUNDING = 1e-9
"""The rounding error of a difference of numbers of segments, and some more."""


def trapezoid(segments: int, blend: int, ramp: int) -> Array:
    """The control values (n + 3,) of s: acceleration is linear between knots, so the curve is the law exactly.

    Args:
        segments: n, at least twice the blend.
        blend: segments of speeding up, at least twice the ramp.
        ramp: segments in which the acceleration rises.
    """
    knot = np.arange(segments + 1)
    rise = np.clip(np.minimum(knot, blend - knot) / ramp, 0.0, 1.0)
    acceleration = rise - rise[::-1]
    # the second difference of the control values is the acceleration at the knots
    control = np.zeros(segments + 3)
    control[2:] = np.cumsum(np.cumsum(acceleration))
    control /= control[-1]
    control[-3:] = 1.0
    return control


def cruise_blend(segments: int, cruise: float) -> int:
    """The whole segments of the blend that n segments leave beside the cruise."""
    return int(segments - cruise + _ROUNDING)


def cruising(segments: int, cruise: float, ramp: int) -> Array:
    """The control values (n + 3,) of a law whose cruise would take the whole way in `cruise` segments, a whole number or not.

    The blend n - cruise lies between two whole numbers: speeding up is a mixture of both.

    Args:
        segments: n, at least two more than `cruise` and at most twice as many.
        cruise: the segments that the way takes at full speed.
        ramp: segments in which the acceleration rises, at most half of the blend.
    """
    rise = _pulse(segments, segments - cruise, ramp)
    return _of_accelerations((rise - rise[::-1]) / cruise)


def between_ramps(segments: int, cruise: float, blend: int, first_ramp: int, last_ramp: int) -> Array:
    """The control values (n + 3,) of a law that speeds up and slows down in different times.

    Args:
        segments: n.
        cruise: the segments that the way takes at full speed, a whole number or not.
        blend: segments of speeding up. Slowing down takes what is left, 2 (n - cruise) - blend.
        first_ramp: segments in which the acceleration rises and falls while speeding up.
        last_ramp: the same while slowing down.
    """
    fall = _pulse(segments, 2.0 * (segments - cruise) - blend, last_ramp)
    return _of_accelerations((_pulse(segments, float(blend), first_ramp) - fall[::-1]) / cruise)


def _pulse(segments: int, blend: float, ramp: int) -> Array:
    """Accelerations (n + 1,) at the knots that add up to 1, from knot 0 on: a mixture of two whole blends."""
    whole = int(blend + _ROUNDING)
    longer = max(blend - whole, 0.0)
    pulse = np.zeros(segments + 1)
    for size, share in ((whole, 1.0 - longer), (whole + 1, longer)):
        if share > 1e-12:
            knot = np.arange(size + 1)
            one = np.clip(np.minimum(knot, size - knot) / max(1, min(ramp, size // 2)), 0.0, 1.0)
            pulse[: size + 1] += share / one.sum() * one
    return pulse


def _of_accelerations(accelerations: Array) -> Array:
    """The control values (n + 3,) whose second differences are the accelerations (n + 1,) at the knots."""
    control = np.zeros(len(accelerations) + 2)
    control[2:] = np.cumsum(np.cumsum(accelerations))
    control[-3:] = 1.0
    return control


def trapezoid_strain(segments: int, forms: NDArray[np.int64]) -> Array:
    """Peaks (K, 3) of velocity, acceleration and jerk over distance, in units of segments, of `forms` (K, 2)."""
    blend, ramp = forms.T
    velocity = 1.0 / (segments - blend)
    acceleration = velocity / (blend - ramp)
    return np.stack((velocity, acceleration, acceleration / ramp), axis=1)
