"""LSPB: a linear segment with parabolic blends, each a third of the time.

The law cruises at 1.5 times distance over time, so that a blend takes a third of the time and the acceleration is
4.5 times distance over time squared. Its acceleration jumps, which no curve with bounded jerk can do: on the
grid each jump becomes a ramp of whole segments. Duration and cruise speed stay those of the law with the
blend rounded to segments.
"""

from __future__ import annotations

import numpy as np

from yarclang.hir import Array
from yarclang.motion.profile import Profile


def _law(u: Array) -> Array:
    u = np.clip(u, 0.0, 1.0)
    middle = 1.5 * u - 0.25
    s: Array = np.where(u < 1 / 3, 2.25 * u**2, np.where(u > 2 / 3, 1.0 - 2.25 * (1.0 - u) ** 2, middle))
    return s


def _blend(segments: int) -> int:
    """The segments of one blend: a third, and room for two ramps of one segment."""
    return max(2, round(segments / 3))


def _longest_ramp(segments: int) -> int:
    return _blend(segments) // 2


def _control(segments: int, ramp: int) -> Array:
    blend = _blend(segments)
    knot = np.arange(segments + 1)
    rise = np.clip(np.minimum(knot, blend - knot) / ramp, 0.0, 1.0)
    acceleration = rise - rise[::-1]
    # the second difference of the control values is the acceleration at the knots
    control = np.zeros(segments + 3)
    control[2:] = np.cumsum(np.cumsum(acceleration))
    control /= control[-1]
    control[-3:] = 1.0
    return control


def _strain(segments: int, ramp: int) -> tuple[float, float, float]:
    blend = _blend(segments)
    velocity = 1.0 / (segments - blend)
    acceleration = velocity / (blend - ramp)
    return velocity, acceleration, acceleration / ramp


PROFILE = Profile(
    name="LSPB",
    summary="linear segment with parabolic blends of a third of the time, corners rounded to the jerk limit",
    law=_law,
    control=_control,
    longest_ramp=_longest_ramp,
    strain=_strain,
)
