"""POLY5: the quintic that starts and ends with zero velocity and acceleration, s = 10 u^3 - 15 u^4 + 6
u^5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.motion.profile import NO_FORM, Form, Law, Profile


def _pure(u: Array) -> Array:
    u = np.clip(u, 0.0, 1.0)
    s: Array = u**3 * (10.0 + u * (-15.0 + 6.0 * u))
    return s


def _control(segments: int, form: Form) -> Array:  # noqa: ARG001  (a smooth law leaves nothing open)
    # A cubic B-spline passes through s at a knot if its control value is s - h² s'' / 6.
    u = np.arange(segments + 1) / segments
    bend = u * (60.0 + u * (-180.0 + 120.0 * u)) / segments**2
    control = np.empty(segments + 3)
    control[1:-1] = _pure(u) - bend / 6.0
    control[:3], control[-3:] = 0.0, 1.0
    return control


def _strain(segments: int, forms: NDArray[np.int64]) -> Array:
    return np.tile([1.875 / segments, 5.774 / segments**2, 60.0 / segments**3], (len(forms), 1))


_LAW = Law(_pure, _control, lambda segments: NO_FORM, _strain)  # noqa: ARG005

PROFILE = Profile(
    name="POLY5",
    summary="a quintic: smooth acceleration that starts and ends at zero",
    law=lambda path, bounds: _LAW,  # noqa: ARG005
)
