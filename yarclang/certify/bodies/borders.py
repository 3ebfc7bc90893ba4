"""Geometry of the convex regions of slow zones: their extent, and directions from them to points."""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import HalfSpace, ShapeRegion
from yarclang.robot.model import Array
from yarclang.shapes import Box, Capsule, Cylinder, Sphere

Region = ShapeRegion | HalfSpace
_NO_LENGTH = 1e-12
"""Vectors shorter than this [m] have no direction."""
_ALONG = 1.0 - 1e-12
"""Least cosine of the angle between a direction and a half-space's normal at which both count as parallel."""


def extent(region: Region, directions: Array) -> Array:
    """Compute the support function of a region in given directions: the largest d . p over its points p.

    Args:
        region: a half-space, or a shape in {B}.
        directions: (3, P) unit vectors d in {B}.

    Returns:
        The extents (P,) [m]; infinite in a direction in which the region is unbounded.
    """
    if isinstance(region, HalfSpace):
        # The half-space of the points p with n . p >= offset is bounded in the direction -n only; n is its
        # normal.
        return np.where(-(region.normal @ directions) >= _ALONG, -region.offset, np.inf)
    placed, shape = region.base_from_shape, region.shape
    # The shape's extent is d . center, plus the extent of the shape around its center, which is computed in
    # the shape's own axes.
    at_center: Array = np.asarray(placed[:3, 3] @ directions)
    local = placed[:3, :3].T @ directions
    if isinstance(shape, Box):
        # In the direction d, a box reaches half of its edges times |d|, summed over its axes.
        return np.asarray(at_center + 0.5 * (shape.size @ np.abs(local)))
    if isinstance(shape, Sphere):
        return np.asarray(at_center + shape.radius)
    ends: Array = 0.5 * shape.length * np.abs(local[2])
    if isinstance(shape, Capsule):
        return np.asarray(at_center + ends + shape.radius)
    rim: Array = shape.radius * np.hypot(local[0], local[1])
    return at_center + ends + rim


def directions_to(region: Region, points: Array) -> Array:
    """Return the unit direction from the nearest point of a region to each point (3, P) in {B}, as (3, P).

    For a point inside the region, the direction leads from the region's axis or center to the point.
    """
    if isinstance(region, HalfSpace):
        return np.repeat(-region.normal[:, None], points.shape[1], axis=1)
    placed, shape = region.base_from_shape, region.shape
    local = placed[:3, :3].T @ (points - placed[:3, 3:4])
    away = local - _nearest(shape, local)
    length = np.sqrt((away**2).sum(axis=0))
    # A point inside is its own nearest point: use the direction from the axis or center instead.
    inside = length < _NO_LENGTH
    away[:, inside], length[inside] = local[:, inside], np.sqrt((local[:, inside] ** 2).sum(axis=0))
    nowhere = length < _NO_LENGTH
    away[:, nowhere], length[nowhere] = np.array([[0.0], [0.0], [1.0]]), 1.0
    turned: Array = placed[:3, :3] @ (away / length)
    return turned


def _nearest(shape: Box | Sphere | Capsule | Cylinder, own: Array) -> Array:
    """Return the point of a shape nearest to each of the points (3, P), in the axes of the shape.

    For a sphere, the center is returned instead, and for a capsule the nearest point of its axis: both are in
    the same direction as the nearest point.
    """
    if isinstance(shape, Box):
        half = shape.size[:, None] / 2.0
        return np.clip(own, -half, half)
    nearest = np.zeros_like(own)
    if isinstance(shape, Sphere):
        return nearest
    nearest[2] = np.clip(own[2], -shape.length / 2.0, shape.length / 2.0)
    if isinstance(shape, Cylinder):
        # Move a point outside of the cylinder radially onto its wall.
        across = np.hypot(own[0], own[1])
        nearest[:2] = own[:2] * np.minimum(1.0, shape.radius / np.maximum(across, _NO_LENGTH))
    return nearest
