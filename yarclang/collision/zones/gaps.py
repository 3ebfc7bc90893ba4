"""Measure the distance of a body or point ("item") from the border of a zone: exactly at instants, and
bounded from below on pieces of a motion's time.

Two theorems are used. First, a point whose acceleration is at most A is, on an interval of d seconds, at most
A d² / 8 from the chord between its positions at the ends. Second, a region's signed distance is convex: on a
chord it is nowhere larger than at the chord's ends. Therefore an item that is inside at both ends of a piece
by more than A d² / 8 is inside on the whole piece. Being outside of a convex region means being beyond some
plane, and the first theorem holds for each plane.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from yarclang.cell.model import HalfSpace
from yarclang.collision.zones.moved import Pieces, Posed, Rates
from yarclang.collision.zones.regions import Place, coal_of, direction, faces_of, outside, reach
from yarclang.collision.zones.watched import Item
from yarclang.shapes import Array


def depth_inside(region: Place, item: Item, posed: Posed) -> Array:
    """Return the depth of an item inside a region at each of P instants (P,) [m]; negative if a point of the
    item is outside.
    """
    faces = faces_of(region)
    if faces is not None:
        # The depth below a face is that of the item's outermost point. The least depth of all faces counts.
        flat: Array = (faces.offsets[:, None] - posed.support(item, faces.normals)).min(axis=0)
        return flat
    # A convex function, such as the signed distance, is largest at a corner of the item's hull.
    points = posed.points(item.rim)
    round_: Array = -outside(region, points).max(axis=1) - item.radius
    return round_


def distance_outside(region: Place, item: Item, posed: Posed, normal: Array | None = None) -> Array:
    """Return the distance of an item from a region at each of P instants (P,) [m]; minus the depth of
    penetration if the two overlap.

    Args:
        region: the region.
        item: the item.
        posed: the motion of the body that carries the item.
        normal: (P, 3) array that receives the unit directions in {B} from the region to the item; or None.
    """
    if isinstance(region, HalfSpace):
        if normal is not None:
            normal[:] = -region.normal
        below: Array = region.offset - posed.support(item, region.normal[None])[0]
        return below
    if item.of_coal is None:
        points = posed.point(item.middle)
        if normal is not None:
            normal[:] = direction(region, points)
        return outside(region, points)
    shape, placed = coal_of(region)
    return _apart(shape, placed, item, posed, normal)


def _apart(shape: Any, placed: Any, item: Item, posed: Posed, normal: Array | None) -> Array:
    """Compute `distance_outside` of a body with the library coal."""
    import coal

    assert item.base_from_body is not None
    request, answer, there = coal.DistanceRequest(), coal.DistanceResult(), coal.Transform3s()
    # Compute the pose of the body's shape at each instant, from its pose with all joints at zero.
    turns = posed.turn.transpose(2, 0, 1) @ item.base_from_body[:3, :3]
    shifts = posed.point(item.base_from_body[:3, 3])
    found = np.empty(len(turns))
    for row, (turn, shift) in enumerate(zip(turns, shifts, strict=True)):
        answer.clear()
        there.setTransform(turn, shift)
        found[row] = coal.distance(shape, placed, item.of_coal, there, request, answer)
        if normal is not None:
            normal[row] = answer.normal
    return found


def roughly_outside(region: Place, item: Item, ends: tuple[Posed, Posed], way: Array) -> Array:
    """Return lower bounds (P,) of the distance of an item from a region on pieces of a motion's time [m],
    from the ball around the item.

    Args:
        region: the region.
        item: the item.
        ends: the motion of the body that carries the item, at the beginnings and at the ends of the pieces.
        way: (P,) upper bounds of the distance that the item's points travel on each piece [m].
    """
    before, behind = (outside(region, posed.point(item.middle)) for posed in ends)
    # The signed distance of a point changes by no more than the point moves.
    least: Array = (before + behind - way) / 2.0 - item.bound
    return least


def least_outside(
    region: Place, item: Item, pieces: Pieces, posed: tuple[Posed, Posed, Posed], bounds: Rates
) -> tuple[Array, Array]:
    """Compute the distance of an item from a region on pieces of a motion's time.

    Args:
        region: the region.
        item: the item.
        pieces: the pieces.
        posed: the motion of the body that carries the item, at the pieces' beginnings, middles and ends.
        bounds: bounds of speed and acceleration of the item's points on all segments.

    Returns:
        Lower bounds of the distance on the pieces, and the distances in their middles, (P,) each [m].
    """
    long = pieces.end - pieces.begin
    normal = np.empty((len(long), 3))
    seen = distance_outside(region, item, posed[1], normal)
    # Use the plane that separates region and item in the middle of the piece. The distance is at least the
    # least gap at the piece's beginning, middle and end, less the deviation A (d/2)² / 8 from the chords in
    # between. Here A bounds the acceleration, and d is the duration of the piece.
    planes = np.minimum.reduce([-one.support_each(item, -normal) for one in posed])
    planes = planes - reach(region, normal) - bounds.second[pieces.segment] * long**2 / 32.0
    least: Array = np.maximum(planes, seen - bounds.first[pieces.segment] * long / 2.0)
    return least, seen
