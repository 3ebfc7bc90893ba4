"""SCURVE: the jerk-limited motion profile.

Acceleration rises and falls in ramps. Ramps, blends and cruise are as long as the limits require, which gives
the shortest duration within the limits. For a given duration, the shape of the shortest profile is stretched.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.motion.profile import Form, Law, Profile
from yarclang.motion.trapezoid import FEWEST_IN_BLEND, trapezoid, trapezoid_strain

_MOST = 96
"""Largest number of lengths of a blend, and of a ramp, that are compared. Longer ranges are sampled in
geometric progression.
"""


def _pure(u: Array) -> Array:
    """Return the profile with ramps and blends as long as possible: full jerk throughout and no cruise."""
    u = np.clip(u, 0.0, 1.0)
    # The jerk is 32 in the first quarter, so that s = 32 u^3 / 6, and -32 in the second. The second half is
    # the point reflection of the first.
    half = np.minimum(u, 1.0 - u)
    rising = np.where(half < 0.25, 16.0 / 3.0 * half**3, 1.0 / 12.0 + _second_quarter(half - 0.25))
    s: Array = np.where(u < 0.5, rising, 1.0 - rising)
    return s


def _second_quarter(w: Array) -> Array:
    # Taylor polynomial from s = 1/12, s' = 1, s'' = 8 and s''' = -32 at the end of the first quarter.
    quarter: Array = w + 4.0 * w**2 - 16.0 / 3.0 * w**3
    return quarter


def _lengths(most: int, least: int) -> NDArray[np.int64]:
    """Return the integers from `least` to `most`; if there are too many, a selection of about `_MOST`."""
    if most - least < _MOST:
        return np.arange(least, most + 1)
    return np.unique(np.round(np.geomspace(least, most, _MOST)).astype(np.int64))


@lru_cache(maxsize=512)
def _forms(segments: int) -> NDArray[np.int64]:
    """Return all combinations of the lengths of blend and ramp, the longest first, since these are the most
    similar ones to the pure profile.
    """
    blends = _lengths(segments // 2, FEWEST_IN_BLEND)[::-1]
    forms = [
        np.stack((np.full_like(ramps, blend), ramps), axis=1)
        for blend in blends.tolist()
        for ramps in [_lengths(blend // 2, 1)[::-1]]
    ]
    return np.concatenate(forms)


def _control(segments: int, form: Form) -> Array:
    return trapezoid(segments, *form)


def _scaled(had: int, form: Form, gets: int) -> Form:
    blend, ramp = form
    longer = min(max(FEWEST_IN_BLEND, round(blend * gets / had)), gets // 2)
    return longer, min(max(1, round(ramp * gets / had)), longer // 2)


_LAW = Law(_pure, _control, _forms, trapezoid_strain, _scaled)

PROFILE = Profile(
    name="SCURVE",
    summary=(
        "jerk-limited: ramps, blends and cruise of the lengths that give the shortest time within the limits"
    ),
    law=lambda path, bounds: _LAW,  # noqa: ARG005
    is_stretched=True,
    has_cruise=True,
    longest_segment=0.02,
)
