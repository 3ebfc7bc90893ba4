"""Compute signed distances of points from the regions of zones.

The signed distance of a point is positive outside, and minus the depth inside. All regions are convex, so the
signed distance is a convex function. It changes by no more than the point moves.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from yarclang.cell.model import HalfSpace, ShapeRegion
from yarclang.collision.geometry import geometry_of
from yarclang.frozen import frozen
from yarclang.shapes import Array, Box, Capsule, Cylinder, Sphere

Place = ShapeRegion | HalfSpace


@frozen(eq=False)
class Faces:
    """A region with flat faces: all points p with normals · p <= offsets, which are (F, 3) and (F,); the
    normals point outwards.
    """

    normals: Array
    offsets: Array


@lru_cache(maxsize=256)
def faces_of(region: Place) -> Faces | None:
    """Return the faces of a region, or None for a round region; cached by the region's identity."""
    if isinstance(region, HalfSpace):
        return Faces(-region.normal[None], np.array([-region.offset]))
    if not isinstance(region.shape, Box):
        return None
    turn, origin = region.base_from_shape[:3, :3], region.base_from_shape[:3, 3]
    normals = np.concatenate([turn.T, -turn.T])
    return Faces(normals, normals @ origin + np.tile(region.shape.size / 2.0, 2))


@lru_cache(maxsize=256)
def coal_of(region: ShapeRegion) -> tuple[Any, Any]:
    """Return a region's shape and pose as objects of the library coal, cached by the region's identity."""
    import coal

    placed = region.base_from_shape
    return geometry_of(region.shape).of_coal, coal.Transform3s(placed[:3, :3], placed[:3, 3])


def outside(region: Place, points: Array) -> Array:
    """Return the signed distances (...,) [m] of points (..., 3) in {B} from a region."""
    if isinstance(region, HalfSpace):
        # The half-space is n . p >= offset, with a unit normal n.
        flat: Array = region.offset - points @ region.normal
        return flat
    local = _local(region, points)
    match region.shape:
        case Box(size=size):
            return _beyond(np.abs(local) - size / 2.0)
        case Sphere(radius=radius):
            return _length(local) - radius
        case Capsule(radius=radius, length=length):
            local[..., 2] -= np.clip(local[..., 2], -length / 2.0, length / 2.0)
            return _length(local) - radius
        case Cylinder(radius=radius, length=length):
            return _beyond(np.stack(_around(local, radius, length), axis=-1))


def direction(region: Place, points: Array) -> Array:
    """Return the gradients (P, 3) in {B} of the signed distance from a region, at points (P, 3).

    For a point outside, the gradient is the unit direction from the region to the point; for a point inside,
    that from the point to the border.
    """
    if isinstance(region, HalfSpace):
        return np.broadcast_to(-region.normal, points.shape)
    local = _local(region, points)
    match region.shape:
        case Box(size=size):
            # The box is symmetric: compute with absolute values, then restore the signs.
            away = _steepest(np.abs(local) - size / 2.0) * np.copysign(1.0, local)
        case Sphere():
            away = local
        case Capsule(length=length):
            away = local
            away[..., 2] -= np.clip(local[..., 2], -length / 2.0, length / 2.0)
        case Cylinder(radius=radius, length=length):
            steep = _steepest(np.stack(_around(local, radius, length), axis=-1))
            # Compute the unit vector from the axis to the point, in the plane across the axis.
            flat = local[:, :2] / np.maximum(_length(local[:, :2]), _TINY)[:, None]
            away = np.concatenate(
                [flat * steep[:, :1], steep[:, 1:] * np.copysign(1.0, local[:, 2:])], axis=1
            )
    size = _length(away)[:, None]
    # At the centre of a ball, any direction is correct.
    unit: Array = np.where(size > _TINY, away / np.maximum(size, _TINY), np.array([0.0, 0.0, 1.0]))
    turned: Array = unit @ region.base_from_shape[:3, :3].T
    return turned


def reach(region: Place, directions: Array) -> Array:
    """Return the support function of a region in unit directions (P, 3): the largest d · p over its points p,
    (P,) [m].

    The value is infinite if the region is unbounded in that direction.
    """
    if isinstance(region, HalfSpace):
        along = directions @ region.normal
        return np.where(along < -1.0 + 1e-12, -region.offset, np.inf)
    turned = directions @ region.base_from_shape[:3, :3]
    # The support function is that of the shape's origin plus that of the shape in its own axes.
    base: Array = directions @ region.base_from_shape[:3, 3]
    match region.shape:
        case Box(size=size):
            return base + np.abs(turned) @ (size / 2.0)
        case Sphere(radius=radius):
            return base + radius
        case Capsule(radius=radius, length=length):
            return base + np.abs(turned[:, 2]) * (length / 2.0) + radius
        case Cylinder(radius=radius, length=length):
            return base + np.abs(turned[:, 2]) * (length / 2.0) + _length(turned[:, :2]) * radius


_TINY = 1e-12


def _local(region: ShapeRegion, points: Array) -> Array:
    local: Array = (points - region.base_from_shape[:3, 3]) @ region.base_from_shape[:3, :3]
    return local


def _around(local: Array, radius: float, length: float) -> tuple[Array, Array]:
    """Return the signed distances of points from the wall of a cylinder, and from its ends [m]; positive
    outside.
    """
    return _length(local[..., :2]) - radius, np.abs(local[..., 2]) - length / 2.0


def _beyond(beyond: Array) -> Array:
    """Return the signed distances of points from a region with perpendicular walls, given the signed
    distances from each wall (..., K).
    """
    # For a point outside, the distance is the length of the positive components. Inside, it is the largest
    # component: the nearest wall counts.
    far = _length(np.maximum(beyond, 0.0))
    signed: Array = np.where(far > 0.0, far, beyond.max(axis=-1))
    return signed


def _steepest(beyond: Array) -> Array:
    """Return the gradient (P, K) of `_beyond`."""
    positive = np.maximum(beyond, 0.0)
    # Outside, the gradient points away from the nearest point of the region; inside, it is the normal of the
    # nearest wall.
    inside = np.eye(beyond.shape[1])[np.argmax(beyond, axis=1)]
    gradient: Array = np.where((positive > _TINY).any(axis=1, keepdims=True), positive, inside)
    return gradient


def _length(vectors: Array) -> Array:
    length: Array = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
    return length
