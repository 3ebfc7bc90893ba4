"""LSPB: the motion profile of a linear segment with parabolic blends, each a third of the duration.

The cruise speed is 1.5 times distance over duration, and the acceleration 4.5 times distance over duration
squared. The acceleration jumps, which a curve with bounded jerk can't follow: on the grid, each jump becomes
a ramp of whole segments. Duration and cruise speed don't depend on these ramps, but the blends are rounded to
whole segments.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.motion.profile import Form, Law, Profile
from yarclang.motion.trapezoid import FEWEST_IN_BLEND, trapezoid, trapezoid_strain


def _pure(u: Array) -> Array:
    u = np.clip(u, 0.0, 1.0)
    # Parabolas in the outer thirds; between them, a line at 1.5 times the mean speed.
    middle = 1.5 * u - 0.25
    s: Array = np.where(u < 1 / 3, 2.25 * u**2, np.where(u > 2 / 3, 1.0 - 2.25 * (1.0 - u) ** 2, middle))
    return s


def _forms(segments: int) -> NDArray[np.int64]:
    """Return the forms for a number of segments. The blend is a third of the segments. Its acceleration ramps
    have all lengths that fit, the steepest first.
    """
    blend = max(FEWEST_IN_BLEND, round(segments / 3))
    ramps = np.arange(1, blend // 2 + 1)
    return np.stack((np.full_like(ramps, blend), ramps), axis=1)


def _control(segments: int, form: Form) -> Array:
    return trapezoid(segments, *form)


_LAW = Law(_pure, _control, _forms, trapezoid_strain)

PROFILE = Profile(
    name="LSPB",
    summary="linear segment with parabolic blends of a third of the time, corners rounded to the jerk limit",
    law=lambda path, bounds: _LAW,  # noqa: ARG005
    has_cruise=True,
)
