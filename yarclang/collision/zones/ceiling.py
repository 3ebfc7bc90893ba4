"""Limit the speed of the frame that a motion moves (`[V<=250]`) by a slow zone that contains all space."""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import HalfSpace, Zone
from yarclang.collision.zones.watched import Moving, point_of
from yarclang.collision.zones.workspace import Watch
from yarclang.robot.model import Robot
from yarclang.transforms import constant
from yarclang.units import MM

_FAR = 1e6
"""Distance that no arm reaches [m]."""

EVERYWHERE = HalfSpace(constant(np.array([0.0, 0.0, 1.0])), -_FAR)


def ceiling_watch(robot: Robot, moving: Moving, speed: float) -> Watch:
    """Return a slow zone, with the origin of a frame as its watched item, that keeps this origin below a
    speed [m/s].
    """
    zone = Zone(f"[V<={speed / MM:.10g} mm/s]", "slow", EVERYWHERE, speed, ("tcp",))
    return Watch(zone, point_of(robot, moving))


def is_ceiling(watch: Watch) -> bool:
    """Return True if a watched zone is a motion's own speed limit, and not a zone of the cell."""
    return watch.zone.region is EVERYWHERE
