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


def trapezoid_strain(segments: int, forms: NDArray[np.int64]) -> Array:
    """Peaks (K, 3) of velocity, acceleration and jerk over distance, in units of segments, of `forms` (K, 2)."""
    blend, ramp = forms.T
    velocity = 1.0 / (segments - blend)
    acceleration = velocity / (blend - ramp)
    return np.stack((velocity, acceleration, acceleration / ramp), axis=1)
