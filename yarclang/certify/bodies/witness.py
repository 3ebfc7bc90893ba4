"""Zones to stay in or out of, looked at a second time: at the ends of all segments, with placements and distances of the judge's own.

This is no proof that a zone is kept: that is the business of `yarclang.collision.zones.proof`, which the planner uses too. It is a witness against it. What it sees
beyond a border is there, exactly: points of what is watched, and balls around them.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import HalfSpace, JointWindow
from yarclang.certify.bodies.borders import Region
from yarclang.certify.bodies.fastest import Joints, Motions
from yarclang.collision.zones.watched import Item
from yarclang.collision.zones.workspace import Watch
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.shapes import Box, Capsule, Sphere

SURE = 2e-5
"""What is beyond a border by less [m] is left to the proof."""
SURE_OF_JOINTS = 2e-6
"""The same of a joint's window [rad or m]."""
_TURNS = 8
"""Points of the rim of a round face."""
_MOST = 1 << 22
"""Coordinates that are computed at a time."""


@frozen
class Seen:
    """What was seen beyond a border: by how much [m, or of a joint rad or m], in which segment, and whether that was at its end."""

    beyond: float
    segment: int
    at_end: bool


def seen_beyond(motions: Motions, watch: Watch) -> list[Seen | None]:
    """Return for each motion what is farthest beyond a zone's border at the ends of its segments; None where nothing is.

    Args:
        motions: segments, and which of them are those of each motion.
        watch: a zone that isn't a slow one, and an item, or none where only joints count.
    """
    cubics = motions.cubics
    q = [cubics.at(np.zeros(len(cubics.h)))[0], cubics.at(cubics.h)[0]]
    if watch.item is None:
        beyond = np.stack([_joints_beyond(watch, one) for one in q])
    else:
        beyond = np.stack(
            [
                _beyond(watch, watch.item, arms, at)
                for arms, at in zip(motions.ends(watch.item.joint), q, strict=True)
            ]
        )
    found: list[Seen | None] = []
    for begin, end in motions.spans.tolist():
        part = beyond[:, begin:end]
        if not part.size or not (part > 0.0).any():
            found.append(None)
            continue
        side, segment = np.unravel_index(int(np.argmax(part)), part.shape)
        found.append(Seen(float(part[side, segment]), begin + int(segment), bool(side)))
    return found


def _joints_beyond(watch: Watch, q: Array) -> Array:
    """Return how far joint positions (N, n) are surely beyond what a window allows, (N,); not above 0 where they aren't."""
    region = watch.zone.region
    assert isinstance(region, JointWindow)
    inside = np.minimum(q - region.lower, region.upper - q).min(axis=1)
    return np.asarray((inside if watch.zone.rule == "forbidden" else -inside) - SURE_OF_JOINTS)


def _beyond(watch: Watch, item: Item, arms: Joints, q: Array) -> Array:
    """Return how far an item is surely beyond a border at N instants, (N,) [m]; not above 0 where it isn't."""
    zone, region = watch.zone, watch.zone.region
    assert not isinstance(region, JointWindow)
    points = _points(item)
    count = len(q)
    found = np.full(count, -np.inf)
    step = max(1, _MOST // (3 * len(points)))
    for begin in range(0, count, step):
        rows = np.arange(begin, min(begin + step, count))
        part = arms.take(rows)
        for own in points:
            away = distances(region, part.point(own))
            if zone.rule == "allowed":
                beyond = away + item.radius + zone.margin
            else:
                beyond = zone.margin + item.radius - away
            found[rows] = np.maximum(found[rows], beyond)
    found -= SURE
    if zone.posture is not None:
        # inside, the joints have to be in the window
        out = np.maximum(zone.posture.lower - q, q - zone.posture.upper).max(axis=1) - SURE_OF_JOINTS
        return np.where(found > 0.0, out, -np.inf)
    return found


def _points(item: Item) -> Array:
    """Return points of an item (K, 3) in {B} with all joints at zero; a round face gives some of its rim."""
    if not item.disc:
        return item.points
    across = np.cross(item.axis, np.eye(3)[int(np.argmin(np.abs(item.axis)))])
    across /= np.linalg.norm(across)
    other = np.cross(item.axis, across)
    turns = 2.0 * np.pi * np.arange(_TURNS) / _TURNS
    rim = item.disc * (np.cos(turns)[:, None] * across + np.sin(turns)[:, None] * other)
    return np.asarray((item.points[:, None] + rim).reshape(-1, 3))


def distances(region: Region, points: Array) -> Array:
    """Return the signed distances (N,) [m] of points (3, N) in {B} from a region: exact outside, and inside that to its nearest border."""
    if isinstance(region, HalfSpace):
        return np.asarray(region.offset - region.normal @ points)
    placed, shape = region.base_from_shape, region.shape
    x, y, z = placed[:3, :3].T @ (points - placed[:3, 3:4])
    if isinstance(shape, Sphere):
        return np.asarray(np.sqrt(x * x + y * y + z * z) - shape.radius)
    if isinstance(shape, Capsule):
        over = np.abs(z) - shape.length / 2.0
        over = np.where(over > 0.0, over, 0.0)
        return np.asarray(np.sqrt(x * x + y * y + over * over) - shape.radius)
    if isinstance(shape, Box):
        gaps = np.abs(np.stack((x, y, z))) - shape.size[:, None] / 2.0
    else:
        gaps = np.stack((np.hypot(x, y) - shape.radius, np.abs(z) - shape.length / 2.0))
    outward = np.where(gaps > 0.0, gaps, 0.0)
    return np.asarray(np.where((gaps > 0.0).any(axis=0), np.sqrt((outward**2).sum(axis=0)), gaps.max(axis=0)))
