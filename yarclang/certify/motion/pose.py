"""Distances and angles between poses."""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array


def angle_of_chord(norm: Array) -> Array:
    """Return the angle [rad] between two rotations whose matrices differ by `norm` in the Frobenius norm.

    For rotations A and B by `angle` from each other, |A - B| = 2 sqrt 2 sin(angle / 2).
    """
    angle: Array = 2.0 * np.arcsin(np.minimum(norm / np.sqrt(8.0), 1.0))
    return angle


def distance(poses: Array, others: Array) -> tuple[Array, Array]:
    """Return the distance [m] and the angle [rad] between poses (..., 4, 4), pair by pair."""
    position: Array = np.linalg.norm(poses[..., :3, 3] - others[..., :3, 3], axis=-1)
    return position, angle_of_chord(np.linalg.norm(poses[..., :3, :3] - others[..., :3, :3], axis=(-2, -1)))


def axis_and_angle(rotation: Array) -> tuple[Array, Array]:
    """Return the axes (C, 3) and angles (C,) in [0, pi] of rotations (C, 3, 3). The axis is zero if the angle
    is zero.
    """
    # The antisymmetric part of a rotation is sin(angle) times its axis, and its trace is 1 + 2 cos(angle).
    vee = (
        np.stack(
            [
                rotation[:, 2, 1] - rotation[:, 1, 2],
                rotation[:, 0, 2] - rotation[:, 2, 0],
                rotation[:, 1, 0] - rotation[:, 0, 1],
            ],
            axis=1,
        )
        / 2.0
    )
    sin = np.linalg.norm(vee, axis=1)
    cos = (np.trace(rotation, axis1=1, axis2=2) - 1.0) / 2.0
    angle = np.arctan2(sin, cos)
    # Near an angle of pi, `vee` vanishes. The axis w is then a column of (1 - cos) w w' = symmetric part -
    # cos I.
    symmetric = (rotation + rotation.transpose(0, 2, 1)) / 2.0 - cos[:, None, None] * np.eye(3)
    column = np.argmax(np.einsum("nii->ni", symmetric), axis=1)
    other = np.take_along_axis(symmetric, column[:, None, None], axis=2)[:, :, 0]
    other *= np.where(np.einsum("ni,ni->n", other, vee) < 0.0, -1.0, 1.0)[:, None]
    axis = np.where((cos > -0.9)[:, None], vee, other)
    length = np.linalg.norm(axis, axis=1)
    turns = length > 1e-100  # for smaller lengths, the squares underflow to zero
    axis = np.where(turns[:, None], axis, 0.0) / np.where(turns, length, 1.0)[:, None]
    return axis, np.where(turns, angle, 0.0)
