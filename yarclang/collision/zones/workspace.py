"""Check joint positions against the zones of a cell, and measure each zone's distance from a violation."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from yarclang.cell.keeping import Pointed, Sight, Tilt
from yarclang.cell.model import Cell, JointWindow, Zone
from yarclang.collision.scene import Rows, Scene, scene_of
from yarclang.collision.zones.gaps import depth_inside, distance_outside
from yarclang.collision.zones.moved import Arm
from yarclang.collision.zones.sights import aimed, reserve
from yarclang.collision.zones.tilts import angles
from yarclang.collision.zones.watched import Item, Moving, items_of
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.collision.zones.windows import room
from yarclang.frozen import frozen
from yarclang.robot.model import Robot
from yarclang.shapes import Array

SLACK = 1e-5
"""Distance beyond a border [m] up to which an item counts as on it."""
TILT_SLACK = 1e-5
"""Excess [rad or m] up to which an axis still counts as within its allowed angle, and a point as within its
cone and its range of distances.
"""


@frozen(eq=False)
class Watch:
    """A zone, with one item (a body or a point) that the zone watches.

    The item is None if the zone concerns only joints, or the flange's orientation.
    """

    zone: Zone
    item: Item | None


def watches_of(robot: Robot, cell: Cell, moving: Moving) -> tuple[Watch, ...]:
    """Return all zones of a cell, once for each item that they watch while a frame is moved, in the order of
    the file.
    """
    return _watches(robot, cell, moving.name, moving.flange_from_moving.tobytes())


@lru_cache(maxsize=64)
def _watches(robot: Robot, cell: Cell, name: str, frame: bytes) -> tuple[Watch, ...]:
    moving = Moving(name, np.frombuffer(frame).reshape(4, 4))
    found: list[Watch] = []
    for zone in cell.zones:
        if isinstance(zone.region, Pointed) or (isinstance(zone.region, JointWindow) and zone.rule != "slow"):
            found.append(Watch(zone, None))
        else:
            found += [Watch(zone, item) for item in items_of(robot, cell, zone, moving)]
    return tuple(found)


def slack_at(scene: Scene, watch: Watch, q: Array) -> Array:
    """Return the slack (P,) of a zone at joint positions (P, n): the distance from a violation.

    The unit is m for a region, rad or m for a joint window, rad for the angle of an axis, and rad or m for a
    cone. A slack below `slack_of` is a violation.
    """
    arm = _one_arm(scene, q.tobytes()) if len(q) == 1 else Arm.at(scene, q)
    return _slack(scene, watch, q, arm, np.arange(len(q)))


@lru_cache(maxsize=16)
def _one_arm(scene: Scene, q: bytes) -> Arm:
    """Place the arm at one joint position. The result is cached, because all zones are evaluated at the same
    position one after the other.
    """
    return Arm.at(scene, np.frombuffer(q)[None])


def _slack(scene: Scene, watch: Watch, q: Array, arm: Arm, rows: Rows) -> Array:
    """Return a zone's distance from a violation, as `slack_at` does, at the instants `rows` of an arm."""
    zone, region = watch.zone, watch.zone.region
    if isinstance(region, JointWindow):
        inner: Array = room(region, q).min(axis=1)
        return inner if zone.rule == "allowed" else -inner
    if isinstance(region, Tilt):
        tilted: Array = region.limit - angles(region, scene.chain, arm.turn[-1][..., rows])
        return tilted
    if isinstance(region, Sight):
        aim = aimed(region, scene.chain, arm.turn[-1][..., rows], arm.shift[-1][..., rows])
        return reserve(region, aim)
    assert watch.item is not None
    posed = arm.of(watch.item).take(rows)
    if zone.rule == "allowed":
        return depth_inside(region, watch.item, posed) - zone.margin
    gap = distance_outside(region, watch.item, posed) - zone.margin
    if zone.posture is None:
        return gap
    wrong = (room(zone.posture, q) < -WINDOW_SLACK / 2.0).any(axis=1)
    return np.where(wrong, gap, np.inf)


def slack_of(watch: Watch) -> float:
    """Return the slack (see `slack_at`) below which a zone counts as violated at an instant. This limit is
    slightly negative, as an allowance for rounding.
    """
    match watch.zone.region:
        case JointWindow():
            return -WINDOW_SLACK / 2.0
        case Tilt() | Sight():
            return -TILT_SLACK / 2.0
    return -SLACK / 2.0


def broken_at(robot: Robot, cell: Cell, moving: Moving, q: Array) -> Sequence[tuple[Watch, float]]:
    """Return the zones that are broken at one joint position (n,), each with its value of `slack_at`
    there.
    """
    made = scene_of(robot, cell)
    if made.value is None:
        return ()
    watches = [one for one in watches_of(robot, cell, moving) if one.zone.rule != "slow"]
    slack = [float(slack_at(made.value, one, q[None])[0]) for one in watches]
    return [(one, by) for one, by in zip(watches, slack, strict=True) if by < slack_of(one)]
