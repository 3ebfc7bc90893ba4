"""Laws that speed up, cruise and slow down, with accelerations that rise and fall in ramps of whole segments.

A form is (blend, ramp): the segments of speeding up (and of slowing down), and of each of its two ramps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array

FEWEST_IN_BLEND = 2
"""A blend is two ramps of one segment at least."""


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


def cruising(segments: int, cruise: float, ramp: int) -> Array:
    """The control values (n + 3,) of a law whose cruise would take the whole way in `cruise` segments, a whole number or not.

    The blend n - cruise lies between two whole numbers: speeding up is a mixture of both.

    Args:
        segments: n, at least two more than `cruise` and at most twice as many.
        cruise: the segments that the way takes at full speed.
        ramp: segments in which the acceleration rises, at most half of the blend.
    """
    blend = int(segments - cruise)
    longer = segments - cruise - blend
    rise = np.zeros(segments + 1)
    for size, share in ((blend, 1.0 - longer), (blend + 1, longer)):
        if share > 0.0:
            pulse = np.clip(np.minimum(np.arange(size + 1), size - np.arange(size + 1)) / ramp, 0.0, 1.0)
            rise[: size + 1] += share / pulse.sum() * pulse
    control = np.zeros(segments + 3)
    control[2:] = np.cumsum(np.cumsum(rise - rise[::-1])) / cruise
    control[-3:] = 1.0
    return control


def trapezoid_strain(segments: int, forms: NDArray[np.int64]) -> Array:
    """Peaks (K, 3) of velocity, acceleration and jerk over distance, in units of segments, of `forms` (K, 2)."""
    blend, ramp = forms.T
    velocity = 1.0 / (segments - blend)
    acceleration = velocity / (blend - ramp)
    return np.stack((velocity, acceleration, acceleration / ramp), axis=1)
