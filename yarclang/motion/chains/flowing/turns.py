"""Compute with orientations as quaternions (scalar first), on whole arrays."""

from __future__ import annotations

import numpy as np

from yarclang.hir import Array


def quaternions(rotations: Array) -> Array:
    """Return quaternions (N, 4) of rotations (N, 3, 3).

    All products of two components are sums of entries of the rotation matrix. The products with the largest
    component give the components most accurately (Shepperd, 1978).
    """
    xx, yy, zz = (rotations[:, i, i] for i in range(3))
    wx, wy, wz = (rotations[:, j, i] - rotations[:, i, j] for i, j in ((1, 2), (2, 0), (0, 1)))
    xy, zx, yz = (rotations[:, j, i] + rotations[:, i, j] for i, j in ((0, 1), (2, 0), (1, 2)))
    # Row i has the products of component i with all components, times four.
    products = np.array(
        [
            [1.0 + xx + yy + zz, wx, wy, wz],
            [wx, 1.0 + xx - yy - zz, xy, zx],
            [wy, xy, 1.0 - xx + yy - zz, yz],
            [wz, zx, yz, 1.0 - xx - yy + zz],
        ]
    )
    largest = np.argmax([products[i, i] for i in range(4)], axis=0)
    found: Array = products[largest, :, np.arange(len(rotations))]
    found /= np.linalg.norm(found, axis=1)[:, None]
    return found


def product(one: Array, other: Array) -> Array:
    """Return products (N, 4) of quaternions: the rotation by `other`, followed by the rotation by `one`."""
    a, b, c, d = one.T
    e, f, g, h = other.T
    # Hamilton product.
    return np.stack(
        (
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ),
        axis=1,
    )


def matrices(turns: Array) -> Array:
    """Return rotations (N, 3, 3) of unit quaternions (N, 4)."""
    # I + 2 w [v]x + 2 [v]x^2 with the vector part v = (x, y, z).
    w, x, y, z = turns.T
    rotations = np.empty((len(turns), 3, 3))
    rotations[:, 0, 0], rotations[:, 1, 1], rotations[:, 2, 2] = (
        1.0 - 2.0 * (y * y + z * z),
        1.0 - 2.0 * (x * x + z * z),
        1.0 - 2.0 * (x * x + y * y),
    )
    rotations[:, 0, 1], rotations[:, 1, 0] = 2.0 * (x * y - z * w), 2.0 * (x * y + z * w)
    rotations[:, 0, 2], rotations[:, 2, 0] = 2.0 * (x * z + y * w), 2.0 * (x * z - y * w)
    rotations[:, 1, 2], rotations[:, 2, 1] = 2.0 * (y * z - x * w), 2.0 * (y * z + x * w)
    return rotations


def steadied(turns: Array) -> Array:
    """Return the quaternions (N, 4), with signs chosen such that consecutive ones are near each other."""
    flips = np.where(np.einsum("ni,ni->n", turns[1:], turns[:-1]) < 0.0, -1.0, 1.0)
    return turns * np.concatenate(([1.0], np.cumprod(flips)))[:, None]


def angle_between(rotations: Array, others: Array) -> Array:
    """Return the angles (N,) [rad] between rotations (N, 3, 3)."""
    # The Frobenius norm of the difference is √8 sin(angle / 2).
    chord = np.linalg.norm((rotations - others).reshape(-1, 9), axis=1)
    found: Array = 2.0 * np.arcsin(np.clip(chord / np.sqrt(8.0), 0.0, 1.0))
    return found
