"""Turns about one fixed axis: between two orientations, and as they go on."""

from __future__ import annotations

import numpy as np

from yarclang.hir import Array
from yarclang.robot.kinematics.fk import skew

NO_TURN = 1e-9
"""A turn smaller than this [rad] has no axis, and needs none."""

HALF_TURN = np.pi - 1e-6
"""A turn beyond this [rad] has no short way."""


def turn_between(first: Array, second: Array) -> tuple[Array, float] | None:
    """The short turn from one rotation (3, 3) to another.

    Returns:
        The axis (3,), a unit vector in the axes of {B}, and the angle [rad]; None for half a turn, which has no short way.
    """
    turn = second @ first.T
    # sine times the axis, and the cosine: well conditioned together for every angle
    sine = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2.0
    cosine = (np.trace(turn) - 1.0) / 2.0
    size = float(np.linalg.norm(sine))
    angle = float(np.arctan2(size, cosine))
    if angle > HALF_TURN:
        return None
    axis = sine / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
    return axis, angle if angle > NO_TURN else 0.0


def turned(rotation: Array, axis: Array, angles: Array) -> Array:
    """`rotation` (3, 3) turned about the unit vector `axis` (3,) in {B} by `angles` (N,) [rad], as (N, 3, 3)."""
    turn = skew(axis)
    angle = angles[:, None, None]
    result: Array = (np.eye(3) + np.sin(angle) * turn + (1.0 - np.cos(angle)) * (turn @ turn)) @ rotation
    return result
