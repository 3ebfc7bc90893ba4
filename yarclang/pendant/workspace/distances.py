"""The smallest distances between bodies, and between bodies and borders of zones, at one joint position. They
are only displayed. Proofs of distances are in certificates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.placing import Placed, box_gaps, place, relative
from yarclang.collision.scene import Rows, Scene, scene_of
from yarclang.collision.zones.watched import Moving
from yarclang.collision.zones.workspace import slack_at, watches_of
from yarclang.robot.model import Array, Robot

MOST = 8
"""Largest number of pairs that are shown."""
_MOST_OWN = 2
"""Largest number of shown pairs in which both bodies belong to the robot. Such bodies are always near to each
other.
"""
_LOOKED_AT = 60
"""Number of pairs of bodies whose distance is computed exactly. They are the pairs whose bounding boxes are
nearest to each other.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Near:
    """The distance between two bodies, or between a body and the border of a zone.

    Attributes:
        first: name of the first body.
        second: name of the second body, or of the zone.
        distance: distance [m].
        margin: required distance [m].
        points: (2, 3) the two points, one on each body, that are nearest to each other, in {B} [m]; None if
            unknown.
    """

    first: str
    second: str
    distance: float
    margin: float
    points: Array | None = None


def nearest(robot: Robot, cell: Cell | None, moving: Moving, q: Array) -> tuple[Near, ...]:
    """Return the pairs of bodies, and of bodies and zones, that are nearest to each other. They are sorted by
    distance minus required margin.

    Args:
        robot: the arm.
        cell: surroundings of the arm; None without a cell.
        moving: frame that zones treat as the tool.
        q: (n,) joint positions [rad or m].
    """
    scene = scene_of(robot, cell).value
    if scene is None:
        return ()
    around = _pairs(scene, q, np.flatnonzero(scene.pairs.of_cell), MOST)
    own = _pairs(scene, q, np.flatnonzero(~scene.pairs.of_cell), _MOST_OWN)
    found = [*around, *own, *(() if cell is None else _zones(robot, cell, scene, moving, q))]
    return tuple(sorted(found, key=_room)[:MOST])


def _room(near: Near) -> float:
    return near.distance - near.margin


def _pairs(scene: Scene, q: Array, pair: Rows, most: int) -> list[Near]:
    """Return the nearest of K pairs of bodies, at most `most`. If several pairs have the same two names, only
    the nearest of them is returned.
    """
    if not len(pair):
        return []
    placed = place(scene, q[None])
    bound = box_gaps(scene, pair, relative(placed, np.zeros_like(pair), pair)) - scene.pairs.margin[pair]
    nearest_pairs: dict[tuple[str, str], Near] = {}
    best: list[float] = []
    for row in np.argsort(bound, kind="stable")[:_LOOKED_AT].tolist():
        if len(best) >= most and bound[row] > best[most - 1]:
            break
        near = _measured(scene, placed, int(pair[row]))
        key = (near.first, near.second)
        if key not in nearest_pairs or _room(near) < _room(nearest_pairs[key]):
            nearest_pairs[key] = near
            best = sorted(map(_room, nearest_pairs.values()))
    return sorted(nearest_pairs.values(), key=_room)[:most]


def _measured(scene: Scene, placed: Placed, pair: int) -> Near:
    import coal

    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = True
    poses = []
    for body in (int(scene.pairs.first[pair]), int(scene.pairs.second[pair])):
        turn = placed.turn[scene.boxes.joint[body], 0] @ scene.boxes.rotation[body]
        shift = placed.middle[body, 0] - turn @ scene.boxes.own_middle[body]
        poses.append((body, coal.Transform3s(turn, shift)))
    (one, here), (other, there) = poses
    first_shape, second_shape = (scene.bodies[body].geometry.of_coal for body in (one, other))
    distance = coal.distance(first_shape, here, second_shape, there, request, answer)
    points = np.array([answer.getNearestPoint1(), answer.getNearestPoint2()])
    second, first = scene.bodies[one].name, scene.bodies[other].name
    shown = points if np.isfinite(points).all() else None
    return Near(first, second, float(distance), float(scene.pairs.margin[pair]), shown)


def _zones(robot: Robot, cell: Cell, scene: Scene, moving: Moving, q: Array) -> list[Near]:
    nearest_zones: dict[tuple[str, str], Near] = {}
    for watch in watches_of(robot, cell, moving):
        if watch.item is None or watch.zone.rule == "slow":
            continue
        # The slack is the distance minus the margin, so the distance is the slack plus the margin.
        room = float(slack_at(scene, watch, q[None])[0])
        if not np.isfinite(room):  # a constraint on the posture has no distance
            continue
        key = (watch.item.name, watch.zone.name)
        distance = room + watch.zone.margin
        if key not in nearest_zones or distance < nearest_zones[key].distance:
            nearest_zones[key] = Near(*key, distance, watch.zone.margin)
    return list(nearest_zones.values())
