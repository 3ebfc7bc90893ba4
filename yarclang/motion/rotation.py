"""Compute rotations about a fixed axis: between two orientations, and beyond them."""

from __future__ import annotations

import numpy as np

from yarclang.hir import Array
from yarclang.robot.kinematics.fk import skew
from yarclang.transforms import constant

NO_TURN = 1e-9
"""Angle below which the axis of a rotation isn't determined, and the rotation counts as none [rad]."""

HALF_TURN = np.pi - 1e-6
"""Angle above which a rotation counts as half a turn, since its direction is ambiguous [rad]."""


def turn_between(first: Array, second: Array) -> tuple[Array, float] | None:
    """Compute the rotation by the smaller angle from one orientation (3, 3) to another.

    Returns:
        The axis (3,), a unit vector in the axes of {B}, and the angle [rad]; None for half a turn, whose
        direction is ambiguous.
    """
    turn = second @ first.T
    # The sine times the axis, and the cosine. Together they determine every angle accurately.
    sine = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2.0
    cosine = (np.trace(turn) - 1.0) / 2.0
    size = float(np.linalg.norm(sine))
    angle = float(np.arctan2(size, cosine))
    if angle > HALF_TURN:
        return None
    axis = sine / size if size > 0.0 else _UP
    return axis, angle if angle > NO_TURN else 0.0


def turns_between(first: Array, second: Array) -> tuple[Array, Array]:
    """Compute the rotations by the smaller angles between pairs of orientations (N, 3, 3). The results are
    identical to those of `turn_between` to the last bit.

    Returns:
        The axes (N, 3), unit vectors in the axes of {B}, and the angles (N,) [rad]; NaN for half a turn,
        whose direction is ambiguous.
    """
    turn = second @ first.transpose(0, 2, 1)
    sines = np.empty((len(turn), 3))
    sines[:, 0] = turn[:, 2, 1] - turn[:, 1, 2]
    sines[:, 1] = turn[:, 0, 2] - turn[:, 2, 0]
    sines[:, 2] = turn[:, 1, 0] - turn[:, 0, 1]
    sines /= 2.0
    cosines = (turn[:, 0, 0] + turn[:, 1, 1] + turn[:, 2, 2] - 1.0) / 2.0
    # Use dot products, as `np.linalg.norm` does for a single vector, so that the results are identical to the
    # last bit.
    sizes = np.sqrt((sines[:, None] @ sines[:, :, None]).ravel())
    angles = np.arctan2(sizes, cosines)
    angles = np.where(angles > NO_TURN, np.where(angles > HALF_TURN, np.nan, angles), 0.0)
    if not sizes.all():
        still = sizes == 0.0
        sines[still], sizes[still] = _UP, 1.0
    return sines / sizes[:, None], angles


_UP = constant(np.array([0.0, 0.0, 1.0]))
"""The axis that is returned for a rotation by zero."""


def turned(rotation: Array, axis: Array, angles: Array) -> Array:
    """Return orientations that are rotated about unit vectors in {B}, by Rodrigues' formula.

    Args:
        rotation: (..., 3, 3) orientations to start from, broadcast against the axes.
        axis: (..., 3) unit vectors, broadcast against the angles.
        angles: (..., N) [rad].

    Returns:
        The rotated orientations (..., N, 3, 3).
    """
    turn = skew(axis)
    angle = angles[..., None, None]
    # Rodrigues' formula: I + sin(angle) K + (1 - cos(angle)) K^2.
    result: Array = (np.eye(3) + np.sin(angle) * turn + (1.0 - np.cos(angle)) * (turn @ turn)) @ rotation
    return result
