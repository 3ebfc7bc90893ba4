"""Compare joint positions with limits: by how much they exceed limits, their nearest full turn within limits,
and limits narrowed by a clearance.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.kinematics.wrist import TURN
from yarclang.robot.model import Array, Chain, Limits

EDGE = 1e-8
"""A joint that exceeds its limit by no more than this [rad or m] is set to the limit."""

CLEAR = 0.05
"""Distance that a redundant arm keeps from its limits if possible [rad or m], but at most a twentieth of the
joint's range.
"""


def nearest_turn(chain: Chain, limits: Limits, q: Array, reference: Array) -> Array:
    """Shift `q` (..., n) by full turns: to the value within limits nearest to the reference, or else to the
    value that exceeds limits least.

    Args:
        chain: the arm, n joints; prismatic joints aren't shifted.
        limits: its limits.
        q: (..., n) [rad or m].
        reference: (..., n) [rad or m].
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
    """Return by how much `q` (..., n) exceeds limits [rad or m]: positive above, negative below, 0 within."""
    result: Array = np.maximum(q - limits.upper, 0.0) + np.minimum(q - limits.lower, 0.0)
    return result


def clear_of_limits(limits: Limits, reference: Array) -> tuple[Array, Array]:
    """Return the limits narrowed by a clearance, as lower and upper (n,) [rad or m]. If the reference would
    exceed a narrowed limit, this limit is widened to the reference.
    """
    room = np.minimum(CLEAR, 0.05 * (limits.upper - limits.lower))
    return (
        np.maximum(limits.lower, np.minimum(limits.lower + room, reference)),
        np.minimum(limits.upper, np.maximum(limits.upper - room, reference)),
    )
