"""Joint positions and limits: how far beyond, on which full turn, and how clear of them."""

from __future__ import annotations

import numpy as np

from yarclang.robot.kinematics.wrist import TURN
from yarclang.robot.model import Array, Chain, Limits

EDGE = 1e-8
"""A joint that is beyond its limit by no more [rad or m] is put on it."""

CLEAR = 0.05
"""How far a redundant arm keeps from its limits where it can [rad or m], at most a twentieth of the range."""


def nearest_turn(chain: Chain, limits: Limits, q: Array, reference: Array) -> Array:
    """`q` (..., n) shifted by full turns: within limits where that can be, there nearest to `reference`
    (..., n), otherwise as little out of them as can be.
    """
    turns = np.round((reference - q) / TURN)
    least = np.ceil((limits.lower - q - EDGE) / TURN)
    most = np.floor((limits.upper - q + EDGE) / TURN)
    fits = least <= most
    inside = np.where(fits, np.clip(turns, least, np.maximum(least, most)), 0.0)
    below, above = limits.lower - (q + TURN * most), (q + TURN * least) - limits.upper
    outside = np.where(above <= below, least, most)
    shifted: Array = q + np.where(chain.is_prismatic, 0.0, TURN * np.where(fits, inside, outside))
    return shifted


def beyond(limits: Limits, q: Array) -> Array:
    """How far `q` (..., n) is out of limits [rad or m]: positive above, negative below, 0 within."""
    result: Array = np.maximum(q - limits.upper, 0.0) + np.minimum(q - limits.lower, 0.0)
    return result


def clear_of_limits(limits: Limits, reference: Array) -> tuple[Array, Array]:
    """Limits (n,) each [rad or m] that keep clear of the real ones, but for where the reference doesn't."""
    room = np.minimum(CLEAR, 0.05 * (limits.upper - limits.lower))
    return (
        np.maximum(limits.lower, np.minimum(limits.lower + room, reference)),
        np.minimum(limits.upper, np.maximum(limits.upper - room, reference)),
    )
