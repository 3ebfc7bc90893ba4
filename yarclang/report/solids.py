"""Convert shapes to triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.geometry import UnreadableError, load_mesh
from yarclang.shapes import Array, Box, Capsule, Cylinder, Mesh, Shape, Sphere

AROUND = 32
"""Number of corners of the polygon that replaces a circle."""
_RINGS = 8
"""Number of rings of triangles of a half sphere."""
_MOST_TRIANGLES = 40_000
"""Largest number of triangles of a mesh that is drawn. A picture needs no more, and a browser can't draw more
30 times a second.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """The surface of a shape, as triangles.

    Attributes:
        vertices: (V, 3) corners in the shape's frame [m].
        faces: (F, 3) three corners for each triangle, counterclockwise seen from outside.
    """

    vertices: Array
    faces: NDArray[np.int64]


def solid_of(shape: Shape) -> Solid | None:
    """Return the surface of a shape; None for a mesh that can't be read."""
    match shape:
        case Box(size=size):
            return _box(size)
        case Sphere(radius=radius):
            return _turned(*_arc(radius, 0.0))
        case Cylinder(radius=radius, length=length):
            half = length / 2.0
            # each edge twice, so that the shading has a crease there
            profile = np.array([[0.0, -half], [radius, -half], [radius, -half], [radius, half]])
            return _turned(*np.vstack([profile, [[radius, half], [0.0, half]]]).T)
        case Capsule(radius=radius, length=length):
            return _turned(*_arc(radius, length / 2.0))
        case Mesh():
            return _mesh(shape)


def cone(angle: float, near: float, far: float) -> Solid:
    """Return the surface of a cone, cut off by two spheres around its apex.

    Args:
        angle: angle between the axis, which is z, and the side [rad].
        near: radius of the inner sphere [m].
        far: radius of the outer sphere [m].
    """
    turn = np.linspace(0.0, angle, _RINGS + 1)
    distance = np.repeat([near, far], _RINGS + 1)
    both = np.concatenate([turn, turn[::-1]])
    return _turned(distance * np.sin(both), distance * np.cos(both))


def _box(size: Array) -> Solid:
    vertices: list[Array] = []
    faces: list[list[int]] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            across, up = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
            middle = side * np.eye(3)[axis]
            first = len(vertices)
            vertices += [middle + a * across + b * up for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            turn = [[0, 1, 2], [0, 2, 3]] if side > 0 else [[0, 2, 1], [0, 3, 2]]
            faces += [[first + corner for corner in face] for face in turn]
    return Solid(np.array(vertices) * size / 2.0, np.array(faces))


def _arc(radius: float, half: float) -> tuple[Array, Array]:
    """Return radii and heights of the profile of a capsule (two half spheres), from the lower pole to the
    upper one.

    Args:
        radius: radius of the half spheres [m].
        half: half the distance of their centres [m].
    """
    angle = np.linspace(0.0, np.pi / 2.0, _RINGS + 1)
    out, up = radius * np.sin(angle), radius * np.cos(angle)
    return np.concatenate([out, out[::-1]]), np.concatenate([-half - up, half + up[::-1]])


def _turned(radius: Array, height: Array) -> Solid:
    """Return the surface that results from rotating a profile about z.

    Args:
        radius: (K,) radii of the profile, from its lower end to its upper one [m].
        height: (K,) heights [m].
    """
    angle = np.arange(AROUND) * (2.0 * np.pi / AROUND)
    x, y = radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle)
    z = np.broadcast_to(height[:, None], x.shape)
    ring, here = np.arange(len(radius) - 1)[:, None] * AROUND, np.arange(AROUND)
    beside = (here + 1) % AROUND
    a, b = (ring + here).ravel(), (ring + beside).ravel()
    faces = np.concatenate([np.stack([a, b, b + AROUND], 1), np.stack([a, b + AROUND, a + AROUND], 1)])
    vertices = np.stack([x, y, z], axis=2).reshape(-1, 3)
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return Solid(vertices, faces[area > 1e-12])


def _mesh(shape: Mesh) -> Solid | None:
    try:
        model = load_mesh(shape)
    except UnreadableError:
        return None
    count = model.num_tris
    vertices = np.array(model.vertices(), dtype=np.float64)
    if not 0 < count <= _MOST_TRIANGLES or not np.isfinite(vertices).all():
        return None
    faces = np.array([[face[side] for side in range(3)] for face in map(model.tri_indices, range(count))])
    # A negative scale reverses the orientation of the triangles.
    if np.prod(shape.scale) < 0.0:
        faces = faces[:, ::-1]
    return Solid(vertices, faces.astype(np.int64))
