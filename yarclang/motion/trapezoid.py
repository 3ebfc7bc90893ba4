"""Compute motion profiles that speed up, cruise and slow down. Their accelerations rise and fall in ramps of
integer numbers of segments.

A form is (blend, ramp). The blend is the number of segments in which the motion speeds up, and also of those
in which it slows down. The ramp is the number of segments in which the acceleration rises, and also of those
in which it falls.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array

FEWEST_IN_BLEND = 2
"""Least number of segments of a blend: two ramps of one segment."""

_ROUNDING = 1e-9
"""Largest rounding error of the difference between two numbers of segments."""


def trapezoid(segments: int, blend: int, ramp: int) -> Array:
    """Return the control values (n + 3,) of the share s of the path for a trapezoidal profile.

    The acceleration is linear between knots, so the spline is exactly the profile.

    Args:
        segments: n, the number of segments of the motion, at least twice the blend.
        blend: number of segments in which the motion speeds up, at least twice the ramp.
        ramp: number of segments in which the acceleration rises.
    """
    knot = np.arange(segments + 1)
    # A trapezoid of acceleration for speeding up, and its mirror image for slowing down.
    rise = np.clip(np.minimum(knot, blend - knot) / ramp, 0.0, 1.0)
    acceleration = rise - rise[::-1]
    # The second difference of the control values is the acceleration at the knots.
    control = np.zeros(segments + 3)
    control[2:] = np.cumsum(np.cumsum(acceleration))
    control /= control[-1]
    control[-3:] = 1.0
    return control


def cruising(segments: int, cruise: float, ramp: int) -> Array:
    """Return the control values (n + 3,) of a profile that speeds up, moves at full speed and slows down.

    The full speed is given by `cruise`: at full speed, the robot would cover the whole path in this number of
    segments, which needn't be an integer. Speeding up takes n - cruise segments, and slowing down takes as
    many. If this number isn't an integer, the accelerations are a mixture of those for the two nearest
    integers.

    Args:
        segments: n, the number of segments of the motion, at least `cruise` + 2 and at most 2 `cruise`.
        cruise: number of segments in which the whole path would be covered at full speed.
        ramp: number of segments in which the acceleration rises, at most half of n - cruise.
    """
    # The accelerations have the sum 1: divided by `cruise`, they add up to a speed of one path per `cruise`
    # segments.
    rise = _pulse(segments, segments - cruise, ramp)
    return _of_accelerations((rise - rise[::-1]) / cruise)


@frozen
class Ramp:
    """A speed ramp: speeding up or slowing down.

    The ramp begins at the time `start` [segments], which needn't be a knot, and takes `width` segments. The
    acceleration rises in `rise` of these segments, and falls in as many.
    """

    start: float
    width: int
    rise: int

    @property
    def middle(self) -> float:
        """The time at which half of the speed is reached, in segments."""
        return self.start + self.width / 2.0


def between_ramps(segments: int, first: Ramp, last: Ramp) -> Array:
    """Return the control values (n + 3,) of a profile that speeds up in one ramp and slows down in another.

    From the middle of the first ramp to the middle of the last one takes as long as the whole path at full
    speed.

    Args:
        segments: n, the number of segments of the motion; both ramps are within these segments.
        first: the ramp that speeds up.
        last: the ramp that slows down.
    """
    pushes = [_shifted(segments, ramp) for ramp in (first, last)]
    return _of_accelerations((pushes[0] - pushes[1]) / (last.middle - first.middle))


def to_rest(segments: int, first: Ramp, cruise: float, rise: int) -> Array:
    """Return the control values (n + 3,) of a profile that speeds up in a given ramp, and comes to rest at
    the end of its last segment.

    Args:
        segments: n, the number of segments of the motion.
        first: the ramp that speeds up.
        cruise: number of segments in which the whole path would be covered at full speed; it needn't be an
            integer.
        rise: number of segments in which the deceleration rises, and in which it falls.
    """
    # The middle of the last ramp is `cruise` segments after that of the first ramp. The last ramp ends with
    # the motion.
    width = 2.0 * (segments - first.middle - cruise)
    return _of_accelerations((_shifted(segments, first) - _pulse(segments, width, rise)[::-1]) / cruise)


def _shifted(segments: int, ramp: Ramp) -> Array:
    """Return the accelerations (n + 1,) at the knots in one speed ramp, scaled to the sum 1.

    If the ramp begins between two knots, the result is a mixture of the ramps that begin at these knots.
    """
    whole = int(ramp.start + _ROUNDING)
    later = max(ramp.start - whole, 0.0)
    knot = np.arange(ramp.width + 1)
    pulse = np.clip(np.minimum(knot, ramp.width - knot) / max(1, min(ramp.rise, ramp.width // 2)), 0.0, 1.0)
    pulse /= pulse.sum()
    pushes = np.zeros(segments + 1)
    # The middle of a mixture of two ramps is between the middles of the two.
    pushes[whole : whole + ramp.width + 1] += (1.0 - later) * pulse
    if later > _ROUNDING:
        pushes[whole + 1 : whole + ramp.width + 2] += later * pulse
    return pushes


def _pulse(segments: int, blend: float, ramp: int) -> Array:
    """Return the accelerations (n + 1,) at the knots while speeding up from knot 0 on, scaled to the sum 1.

    If `blend` isn't an integer, the result is a mixture of the accelerations for the two nearest integers.
    """
    whole = int(blend + _ROUNDING)
    longer = max(blend - whole, 0.0)
    pulse = np.zeros(segments + 1)
    for size, share in ((whole, 1.0 - longer), (whole + 1, longer)):
        if share > 1e-12:
            knot = np.arange(size + 1)
            shape = np.clip(np.minimum(knot, size - knot) / max(1, min(ramp, size // 2)), 0.0, 1.0)
            pulse[: size + 1] += share / shape.sum() * shape
    return pulse


def _of_accelerations(accelerations: Array) -> Array:
    """Return the control values (n + 3,) whose second differences are the given accelerations (n + 1,) at the
    knots.
    """
    # Sum twice: this is the inverse of the second difference. The constants of summation are two zeros.
    control = np.zeros(len(accelerations) + 2)
    control[2:] = np.cumsum(np.cumsum(accelerations))
    control[-3:] = 1.0
    return control


def trapezoid_strain(segments: int, forms: NDArray[np.int64]) -> Array:
    """Return the peaks (K, 3) of velocity, acceleration and jerk of trapezoidal profiles with `forms` (K, 2).

    The unit of length is the length of the path, and the unit of time is one segment.
    """
    blend, ramp = forms.T
    # The speed over time is a trapezoid of height v and width `segments`, with flanks of `blend` segments.
    # Its area v (segments - blend) is the path's length, 1. The acceleration in a blend is a trapezoid too,
    # with the area v.
    velocity = 1.0 / (segments - blend)
    acceleration = velocity / (blend - ramp)
    return np.stack((velocity, acceleration, acceleration / ramp), axis=1)
