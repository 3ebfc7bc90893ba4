"""How far an item is from the border of a zone: at instants exactly, on pieces of a motion at least.

Two theorems carry it. A point whose acceleration is at most A is, within d seconds, no farther than A d^2 / 8 from the chord between where it is before and
behind. And a region's signed distance is convex: on a chord it is nowhere larger than at its ends. So what is inside at both ends of a piece by
more than that, is inside all along. To be outside of a convex region is to be beyond some plane, and each plane has the first theorem.
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
    """How far an item is inside a region at each instant (P,) [m]; negative by how far it sticks out."""
    faces = faces_of(region)
    if faces is not None:
        flat: Array = (faces.offsets[:, None] - posed.support(item, faces.normals)).min(axis=0)
        return flat
    points = posed.points(item.rim)
    round_: Array = -outside(region, points).max(axis=1) - item.radius
    return round_


def distance_outside(region: Place, item: Item, posed: Posed, normal: Array | None = None) -> Array:
    """How far an item is from a region at each instant (P,) [m]; negative by how deep it is in.

    `normal` (P, 3) is filled with the unit directions in {B} from the region to the item.
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
    """The same by coal, for bodies."""
    import coal

    assert item.base_from_body is not None
    request, answer, there = coal.DistanceRequest(), coal.DistanceResult(), coal.Transform3s()
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
    """A lower bound (P,) of how far an item is from a region on pieces [m], from balls around it; `way` (P,) is the longest that its points go."""
    before, behind = (outside(region, posed.point(item.middle)) for posed in ends)
    least: Array = (before + behind - way) / 2.0 - item.bound
    return least


def least_outside(
    region: Place, item: Item, pieces: Pieces, posed: tuple[Posed, Posed, Posed], bounds: Rates
) -> tuple[Array, Array]:
    """How far an item is from a region on pieces: at least, and in the middle, (P,) each [m]; `posed` are what moves it at their begins, middles and ends."""
    long = pieces.end - pieces.begin
    normal = np.empty((len(long), 3))
    seen = distance_outside(region, item, posed[1], normal)
    # beyond the plane that holds both apart in the middle, with what it lies behind its chord
    planes = np.minimum.reduce([-one.support_each(item, -normal) for one in posed])
    planes = planes - reach(region, normal) - bounds.second[pieces.segment] * long**2 / 32.0
    least: Array = np.maximum(planes, seen - bounds.first[pieces.segment] * long / 2.0)
    return least, seen
