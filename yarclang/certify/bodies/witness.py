"""A second check of zones, except slow ones, with the judge's own placements and distances.

It examines only the ends of segments. Therefore it proves nothing itself, but it can refute the proof of
`yarclang.collision.zones.proof`, which the planner uses too. What it reports beyond a border is certain: it
examines points of the watched bodies, and balls around these points.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import HalfSpace, JointWindow, Unplaced
from yarclang.certify.bodies.borders import Region
from yarclang.certify.bodies.fastest import Joints, Motions
from yarclang.collision.zones.watched import Item
from yarclang.collision.zones.workspace import Watch
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.shapes import Box, Capsule, Sphere

SURE = 2e-5
"""Distance beyond a border up to which only the proof decides [m]."""
SURE_OF_JOINTS = 2e-6
"""Distance beyond the end of a joint's window up to which only the proof decides [rad or m]."""
_TURNS = 8
"""Points on the rim of a round face."""
_MOST = 1 << 22
"""Coordinates that are computed in one step."""


@frozen
class Seen:
    """An instant at which a watched body or joint is beyond the border of a zone.

    Attributes:
        beyond: distance beyond the border [m, or rad or m of a joint].
        segment: index of the segment.
        at_end: True at the end of the segment, False at its start.
    """

    beyond: float
    segment: int
    at_end: bool


def seen_beyond(motions: Motions, watch: Watch) -> list[Seen | None]:
    """Return each motion's segment end that is farthest beyond a zone's border; None if none is beyond.

    Args:
        motions: the segments, and the range of each motion.
        watch: a zone other than a slow one, with the watched body, or no body if only joints are watched.
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
    """Return by how much joints `q` (N, n) certainly violate a window of joint positions (N,) [rad or m].

    A distance is not positive if the window is respected.
    """
    region = watch.zone.region
    assert isinstance(region, JointWindow)
    inside = np.minimum(q - region.lower, region.upper - q).min(axis=1)
    return np.asarray((inside if watch.zone.rule == "forbidden" else -inside) - SURE_OF_JOINTS)


def _beyond(watch: Watch, item: Item, arms: Joints, q: Array) -> Array:
    """Return by how far a body is certainly beyond a zone's border (N,) [m]; not positive if it isn't.

    In a zone with a posture, they are distances of the joints from the posture's window [rad or m].
    """
    zone, region = watch.zone, watch.zone.region
    assert not isinstance(region, Unplaced)
    points = _points(item)
    count = len(q)
    found = np.full(count, -np.inf)
    step = max(1, _MOST // (3 * len(points)))
    for begin in range(0, count, step):
        rows = np.arange(begin, min(begin + step, count))
        part = arms.take(rows)
        for own in points:
            # Points of the body with a ball around each are certain; other points are not examined.
            away = distances(region, part.point(own))
            if zone.rule == "allowed":
                beyond = away + item.radius + zone.margin
            else:
                beyond = zone.margin + item.radius - away
            found[rows] = np.maximum(found[rows], beyond)
    found -= SURE
    if zone.posture is not None:
        # Inside the zone, the joints must be in the window.
        out = np.maximum(zone.posture.lower - q, q - zone.posture.upper).max(axis=1) - SURE_OF_JOINTS
        return np.where(found > 0.0, out, -np.inf)
    return found


def _points(item: Item) -> Array:
    """Return points (K, 3) of a body in {B} with all joints at zero; points on the rims of round faces."""
    if not item.disc:
        return item.points
    across = np.cross(item.axis, np.eye(3)[int(np.argmin(np.abs(item.axis)))])
    across /= np.linalg.norm(across)
    other = np.cross(item.axis, across)
    turns = 2.0 * np.pi * np.arange(_TURNS) / _TURNS
    rim = item.disc * (np.cos(turns)[:, None] * across + np.sin(turns)[:, None] * other)
    return np.asarray((item.points[:, None] + rim).reshape(-1, 3))


def distances(region: Region, points: Array) -> Array:
    """Return the signed distances (N,) [m] from a region to points (3, N) in {B}; negative for points inside.

    A distance inside is that from the nearest border of the region.
    """
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
