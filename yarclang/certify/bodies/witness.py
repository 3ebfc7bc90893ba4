"""A second check of zones, except slow ones, with the judge's own placements and distances.

The check examines only the ends of segments. Therefore it proves nothing itself, but it can refute the proof
of `yarclang.collision.zones.proof`, which the planner uses too. A violation that the check reports is
certain, since the points that it examines, and the balls around them, belong to the watched bodies.
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
"""A sample that is no farther than this beyond a zone's border refutes nothing: only the proof decides [m].
"""
SURE_OF_JOINTS = 2e-6
"""A sample that is no farther than this beyond the end of a joint's window refutes nothing [rad or m]."""
_TURNS = 8
"""Number of points on the rim of a round face."""
_MOST = 1 << 22
"""Number of coordinates that are computed in one step."""


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
    worst: list[Seen | None] = []
    for begin, end in motions.spans.tolist():
        part = beyond[:, begin:end]
        if not part.size or not (part > 0.0).any():
            worst.append(None)
            continue
        side, segment = np.unravel_index(int(np.argmax(part)), part.shape)
        worst.append(Seen(float(part[side, segment]), begin + int(segment), bool(side)))
    return worst


def _joints_beyond(watch: Watch, q: Array) -> Array:
    """Return the amount (N,) [rad or m] by which joints `q` (N, n) violate a window of joint positions, less
    `SURE_OF_JOINTS`.

    If the result is not positive, no violation is certain.
    """
    region = watch.zone.region
    assert isinstance(region, JointWindow)
    inside = np.minimum(q - region.lower, region.upper - q).min(axis=1)
    return np.asarray((inside if watch.zone.rule == "forbidden" else -inside) - SURE_OF_JOINTS)


def _beyond(watch: Watch, item: Item, arms: Joints, q: Array) -> Array:
    """Return the distance (N,) [m] by which a body is surely beyond a zone's border; not positive if this
    isn't sure.

    For a zone with a posture, return instead the amount by which the joints of a body inside the zone are out
    of the posture's window [rad or m]; minus infinity for a body outside of the zone.
    """
    zone, region = watch.zone, watch.zone.region
    assert not isinstance(region, Unplaced)
    points = _points(item)
    count = len(q)
    farthest = np.full(count, -np.inf)
    step = max(1, _MOST // (3 * len(points)))
    for begin in range(0, count, step):
        rows = np.arange(begin, min(begin + step, count))
        part = arms.take(rows)
        for own in points:
            # Each of these points, with the ball around it, certainly belongs to the body. Other points
            # aren't examined.
            away = distances(region, part.point(own))
            if zone.rule == "allowed":
                beyond = away + item.radius + zone.margin
            else:
                beyond = zone.margin + item.radius - away
            farthest[rows] = np.maximum(farthest[rows], beyond)
    farthest -= SURE
    if zone.posture is not None:
        # The body may break the posture only outside of the zone: inside it, the joints must be in the
        # posture's window.
        out = np.maximum(zone.posture.lower - q, q - zone.posture.upper).max(axis=1) - SURE_OF_JOINTS
        return np.where(farthest > 0.0, out, -np.inf)
    return farthest


def _points(item: Item) -> Array:
    """Return points (K, 3) of a body in {B} with all joints at zero: its corners or, if it has round faces,
    points on their rims.
    """
    if not item.disc:
        return item.points
    # Compute two unit vectors across the axis; the first is made from the unit vector that is least aligned
    # with the axis.
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
    # A ball or a capsule is all points within `radius` of its centre or centre line.
    if isinstance(shape, Sphere):
        return np.asarray(np.sqrt(x * x + y * y + z * z) - shape.radius)
    if isinstance(shape, Capsule):
        over = np.abs(z) - shape.length / 2.0
        over = np.where(over > 0.0, over, 0.0)
        return np.asarray(np.sqrt(x * x + y * y + over * over) - shape.radius)
    # A box is an intersection of slabs, a cylinder that of a slab and an infinite cylinder. Outside, the
    # positive gaps are the legs of a right triangle, and the distance is its hypotenuse. Inside, the border
    # with the largest (least negative) gap is nearest.
    if isinstance(shape, Box):
        gaps = np.abs(np.stack((x, y, z))) - shape.size[:, None] / 2.0
    else:
        gaps = np.stack((np.hypot(x, y) - shape.radius, np.abs(z) - shape.length / 2.0))
    outward = np.where(gaps > 0.0, gaps, 0.0)
    return np.asarray(np.where((gaps > 0.0).any(axis=0), np.sqrt((outward**2).sum(axis=0)), gaps.max(axis=0)))
