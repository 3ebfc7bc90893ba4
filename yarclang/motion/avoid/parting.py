"""Detect, without a search, forbidden zones that certainly separate two joint positions.

If there is such a zone, no motion leads from one of the two joint positions to the other.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import JointWindow, ShapeRegion
from yarclang.collision.zones.moved import Arm
from yarclang.collision.zones.watched import Item
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.collision.zones.workspace import SLACK, Watch
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.room import Room
from yarclang.robot.kinematics.fk import lines_of
from yarclang.robot.model import Chain, Limits
from yarclang.shapes import Box


@frozen
class Parting:
    """A forbidden range of a single joint, with start and goal on opposite sides of this range.

    The zone `name` forbids the positions from `lower` to `upper` [rad or m] of joint number `joint`, counted
    from 0.
    """

    name: str
    joint: int
    lower: float
    upper: float


@frozen
class Barrier:
    """A forbidden box that the arm can't get past.

    `name` is the name of the zone. The watched `item` is on one side of the box at the start, and on the
    opposite side at the goal.
    """

    name: str
    item: str


def parting(room: Room, start: Array, goal: Array) -> Parting | Barrier | None:
    """Return a zone that certainly separates the joint positions `start` and `goal` (n,) [rad or m]; None if
    no zone certainly does.
    """
    for watch in room.watches:
        if watch.zone.rule != "forbidden":
            continue
        found = _window(room.robot.limits, watch, start, goal) or _barrier(room, watch, start, goal)
        if found is not None:
            return found
    return None


def _window(limits: Limits, watch: Watch, start: Array, goal: Array) -> Parting | None:
    window = watch.zone.region
    if not isinstance(window, JointWindow):
        return None
    narrows = (window.lower > limits.lower) | (window.upper < limits.upper)
    if np.count_nonzero(narrows) != 1:
        return None
    joint = int(np.argmax(narrows))
    lower, upper = float(window.lower[joint]), float(window.upper[joint])
    low, high = sorted((float(start[joint]), float(goal[joint])))
    # A range narrower than the resolution of the proof separates nothing.
    if low <= lower and upper <= high and upper - lower > 4.0 * WINDOW_SLACK:
        return Parting(watch.zone.name, joint, lower, upper)
    return None


def _barrier(room: Room, watch: Watch, start: Array, goal: Array) -> Barrier | None:
    """Return a box zone as a barrier between start and goal; None if a point might get past the box.

    A box is a barrier if start and goal are beyond two opposite faces, and the watched item can't reach the
    other four faces. Every motion from one side to the other then goes through the box.
    """
    region, item = watch.zone.region, watch.item
    if item is None or watch.zone.posture is not None:
        return None
    if not (isinstance(region, ShapeRegion) and isinstance(region.shape, Box)):
        return None
    middle, radius = _reach(room.robot.chain, room.robot.limits, item)
    turn, origin = region.base_from_shape[:3, :3], region.base_from_shape[:3, 3]
    half = region.shape.size / 2.0
    # True for each axis of the box along which the item's point always stays between the two faces.
    covered = np.abs((middle - origin) @ turn) + radius < half
    posed = Arm.at(room.scene, np.stack([start, goal])).of(item)
    sides = (posed.point(item.points[0]) - origin) @ turn
    for axis in range(3):
        low, high = sorted(sides[:, axis].tolist())
        if (
            np.delete(covered, axis).all()
            and low < -half[axis] < half[axis] < high
            and half[axis] > 2.0 * SLACK
        ):
            return Barrier(watch.zone.name, item.name)
    return None


def _reach(chain: Chain, limits: Limits, item: Item) -> tuple[Array, float]:
    """Return a ball that the first point of a watched item never leaves, as its center (3,) in {B} and its
    radius [m].

    A rotation doesn't change the distance of a point from any point on the rotation axis. The radius is
    therefore a sum of distances: from the item's point to the nearest point on the last axis, from there to
    the nearest point on the axis before, and so on to the first axis. The travel of all prismatic joints is
    added.
    """
    lines, way = lines_of(chain), np.maximum(np.abs(limits.lower), np.abs(limits.upper))
    point, radius = item.points[0], 0.0
    for joint in reversed(range(item.joint)):
        slide = abs(float(lines.slide[joint]))
        # Add the travel of a sliding joint, in either direction.
        radius += slide * float(way[joint]) if slide else 0.0
        if lines.turn[joint]:
            axis, origin = lines.axes[joint], lines.points[joint]
            nearest = origin + axis * float(axis @ (point - origin))
            radius += float(np.linalg.norm(point - nearest))
            point = nearest
    return point, radius
