"""Rotations as the judge computes them: products of rotations about axes."""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array


def cross_matrix(vectors: Array) -> Array:
    """Return the matrices (..., 3, 3) [v]x that compute the cross product v x y for vectors v (..., 3).

    Column i is the cross product of v with unit vector i.
    """
    return np.cross(vectors[..., None, :], np.eye(3)).swapaxes(-1, -2)


def turn(axis: Array, angle: Array) -> Array:
    """Return the rotations (..., 3, 3) about a unit axis (3,) by angles (...) [rad].

    Rodrigues' formula: c I + (1 - c) a a' + s [a]x, with c = cos(angle), s = sin(angle) and the unit axis a.
    """
    cosine, sine = np.cos(angle)[..., None, None], np.sin(angle)[..., None, None]
    made: Array = cosine * np.eye(3) + (1.0 - cosine) * np.outer(axis, axis) + sine * cross_matrix(axis)
    return made


def of_roll_pitch_yaw(angles: Array) -> Array:
    """Return the rotation matrices (..., 3, 3) of roll, pitch and yaw angles (..., 3) [rad].

    They turn about the fixed x axis by roll, then about the fixed y axis by pitch, then about the fixed z
    axis by yaw.
    """
    x, y, z = np.eye(3)
    return turn(z, angles[..., 2]) @ turn(y, angles[..., 1]) @ turn(x, angles[..., 0])


def of_quaternion(quaternions: Array) -> Array:
    """Return the rotation matrices (..., 3, 3) of nonzero quaternions (..., 4) with the real part last."""
    length = np.einsum("...i,...i->...", quaternions, quaternions)[..., None, None]
    spin, real = cross_matrix(quaternions[..., :3]), quaternions[..., 3, None, None]
    made: Array = np.eye(3) + (2.0 / length) * (real * spin + spin @ spin)
    return made


def of_numbers(numbers: Array) -> Array:
    """Return the transforms (..., 4, 4) of poses given by six or seven numbers.

    The numbers are x y z and roll pitch yaw (..., 6) [m, rad], or x y z and a quaternion (..., 7).
    """
    made = np.zeros((*numbers.shape[:-1], 4, 4))
    angles = numbers[..., 3:]
    made[..., :3, :3] = of_roll_pitch_yaw(angles) if angles.shape[-1] == 3 else of_quaternion(angles)
    made[..., :3, 3], made[..., 3, 3] = numbers[..., :3], 1.0
    return made


def pose(rotation: Array, origin: Array) -> Array:
    """Return the transform (4, 4) of a rotation (3, 3) and an origin (3,)."""
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = rotation, origin
    return made


def inverse(placed: Array) -> Array:
    """Return the inverse (4, 4) of a transform (4, 4)."""
    back = placed[:3, :3].T
    return pose(back, -back @ placed[:3, 3])
