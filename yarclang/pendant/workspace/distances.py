"""The nearest pairs of bodies and the nearest borders of zones at one joint position, to be shown: what is proved stands in certificates."""

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
"""Pairs that are shown."""
_MOST_OWN = 2
"""Pairs of the robot's own bodies among them: these are always near."""
_LOOKED_AT = 60
"""Pairs whose distance is computed exactly: those that are nearest by their boxes."""


@dataclass(frozen=True, slots=True, eq=False)
class Near:
    """Two things by their names: `distance` and `margin` [m]; `points` (2, 3) are the nearest points in {B} [m], None without such."""

    first: str
    second: str
    distance: float
    margin: float
    points: Array | None = None


def nearest(robot: Robot, cell: Cell | None, moving: Moving, q: Array) -> tuple[Near, ...]:
    """Return what is nearest to what, the least room first.

    Args:
        robot: the arm.
        cell: its surroundings.
        moving: the frame that zones watch as the tool.
        q: (n,) [rad or m].
    """
    scene = scene_of(robot, cell).value
    if scene is None:
        return ()
    around = _pairs(scene, q, np.flatnonzero(scene.pairs.of_cell), MOST)
    own = _pairs(scene, q, np.flatnonzero(~scene.pairs.of_cell), _MOST_OWN)
    found = [*around, *own, *(() if cell is None else _zones(robot, cell, scene, moving, q))]
    return tuple(sorted(found, key=_room)[:MOST])


def _room(one: Near) -> float:
    return one.distance - one.margin


def _pairs(scene: Scene, q: Array, pair: Rows, most: int) -> list[Near]:
    """Return the nearest of some pairs (K,), each two names once."""
    if not len(pair):
        return []
    placed = place(scene, q[None])
    bound = box_gaps(scene, pair, relative(placed, np.zeros_like(pair), pair)) - scene.pairs.margin[pair]
    found: dict[tuple[str, str], Near] = {}
    best: list[float] = []
    for row in np.argsort(bound, kind="stable")[:_LOOKED_AT].tolist():
        if len(best) >= most and bound[row] > best[most - 1]:
            break
        near = _measured(scene, placed, int(pair[row]))
        key = (near.first, near.second)
        if key not in found or _room(near) < _room(found[key]):
            found[key] = near
            best = sorted(map(_room, found.values()))
    return sorted(found.values(), key=_room)[:most]


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
    distance = coal.distance(
        scene.boxes.of_coal[one], here, scene.boxes.of_coal[other], there, request, answer
    )
    points = np.array([answer.getNearestPoint1(), answer.getNearestPoint2()])
    second, first = scene.bodies[one].name, scene.bodies[other].name
    shown = points if np.isfinite(points).all() else None
    return Near(first, second, float(distance), float(scene.pairs.margin[pair]), shown)


def _zones(robot: Robot, cell: Cell, scene: Scene, moving: Moving, q: Array) -> list[Near]:
    found: dict[tuple[str, str], Near] = {}
    for watch in watches_of(robot, cell, moving):
        if watch.item is None or watch.zone.rule == "slow":
            continue
        # what a border asks for has its margin taken off already
        room = float(slack_at(scene, watch, q[None])[0])
        if not np.isfinite(room):  # a posture that is kept
            continue
        key = (watch.item.name, watch.zone.name)
        distance = room + watch.zone.margin
        if key not in found or distance < found[key].distance:
            found[key] = Near(*key, distance, watch.zone.margin)
    return list(found.values())
