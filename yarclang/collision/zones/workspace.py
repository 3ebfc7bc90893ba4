"""What the zones of a cell ask of joint positions: whether they are in the allowed workspace, and by how much."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from yarclang.cell.model import Cell, JointWindow, Zone
from yarclang.collision.scene import Rows, Scene, scene_of
from yarclang.collision.zones.gaps import depth_inside, distance_outside
from yarclang.collision.zones.moved import Arm
from yarclang.collision.zones.watched import Item, Moving, items_of
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.collision.zones.windows import room
from yarclang.frozen import frozen
from yarclang.robot.model import Robot
from yarclang.shapes import Array

SLACK = 1e-5
"""What is beyond a border by no more than this [m] isn't told from what is on it."""


@frozen(eq=False)
class Watch:
    """A zone, and an item that it watches; None where only joints count."""

    zone: Zone
    item: Item | None


def watches_of(robot: Robot, cell: Cell, moving: Moving) -> tuple[Watch, ...]:
    """All that the zones of a cell watch while a frame is moved, in the order of the file."""
    return _watches(robot, cell, moving.name, moving.flange_from_moving.tobytes())


@lru_cache(maxsize=64)
def _watches(robot: Robot, cell: Cell, name: str, frame: bytes) -> tuple[Watch, ...]:
    moving = Moving(name, np.frombuffer(frame).reshape(4, 4))
    found: list[Watch] = []
    for zone in cell.zones:
        if isinstance(zone.region, JointWindow) and zone.rule != "slow":
            found.append(Watch(zone, None))
        else:
            found += [Watch(zone, item) for item in items_of(robot, cell, zone, moving)]
    return tuple(found)


def slack_at(scene: Scene, watch: Watch, q: Array) -> Array:
    """How far a watch is from being broken at joint positions (P, n), (P,) [m, of a joint window rad or m]: below `slack_of` it is."""
    arm = _one_arm(scene, q.tobytes()) if len(q) == 1 else Arm.at(scene, q)
    return _slack(watch, q, arm, np.arange(len(q)))


@lru_cache(maxsize=16)
def _one_arm(scene: Scene, q: bytes) -> Arm:
    """The arm at one joint position: all watches are asked there, one after the other."""
    return Arm.at(scene, np.frombuffer(q)[None])


def _slack(watch: Watch, q: Array, arm: Arm, rows: Rows) -> Array:
    """The same of some of the instants of an arm."""
    zone, region = watch.zone, watch.zone.region
    if isinstance(region, JointWindow):
        inner: Array = room(region, q).min(axis=1)
        return inner if zone.rule == "allowed" else -inner
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
    """Below this a watch counts as broken where it is looked at."""
    return -(WINDOW_SLACK if isinstance(watch.zone.region, JointWindow) else SLACK) / 2.0


def broken_at(robot: Robot, cell: Cell, moving: Moving, q: Array) -> Sequence[tuple[Watch, float]]:
    """The watches that one joint position (n,) breaks, each with its slack there, as in `slack_at`."""
    made = scene_of(robot, cell)
    if made.value is None:
        return ()
    watches = [one for one in watches_of(robot, cell, moving) if one.zone.rule != "slow"]
    slack = [float(slack_at(made.value, one, q[None])[0]) for one in watches]
    return [(one, by) for one, by in zip(watches, slack, strict=True) if by < slack_of(one)]
