"""Which motions flow into each other, and which of their segments follow their own path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify.ball import radii
from yarclang.certify.layout import Layout, Place
from yarclang.robot.model import Array, Robot

IN_JOINTS = (hir.JointMove, hir.SplineMove)


@dataclass(frozen=True, slots=True)
class Corner:
    """Motion number `first` flows into motion number `second`, over `segments` segments.

    `rounded` says that a ball is allowed; without one, both paths are followed up to the corner. Between two motions in joint
    space each joint has its own ball, else the moving frame.
    """

    first: int
    second: int
    segments: int
    rounded: bool
    joints: bool


@dataclass(frozen=True, slots=True, eq=False)
class Flows:
    """Of each of P motions: the segments `follow` (P, 2), from and up to, that go along its path, and whether the path is joined and
    left elsewhere than at its ends, `free` (P, 2). The corners, in order.
    """

    follow: NDArray[np.int64]
    free: NDArray[np.bool_]
    corners: tuple[Corner, ...]


def find_flows(layout: Layout, robot: Robot) -> Flows:
    """Where the motions of a text flow into each other."""
    count = len(layout.places)
    follow = np.array([[place.first, place.last] for place in layout.places], dtype=np.int64).reshape(
        count, 2
    )
    free = np.zeros((count, 2), dtype=np.bool_)
    corners = []
    before = 0
    for row, place in enumerate(layout.places):
        if not place.size:
            continue
        if place.before is not None:
            corner = _corner(layout, robot, before, row, place.before)
            corners.append(corner)
            if corner.rounded:
                follow[before, 1] -= corner.segments // 2
                follow[row, 0] += corner.segments // 2
                free[before, 1] = free[row, 0] = True
        before = row
    return Flows(follow, free, tuple(corners))


def _corner(layout: Layout, robot: Robot, first: int, second: int, segments: int) -> Corner:
    one, other = layout.places[first].motion, layout.places[second].motion
    joints = isinstance(one, IN_JOINTS) and isinstance(other, IN_JOINTS)
    blend = one.blend
    assert blend is not None  # as the map and the program agree
    size = float(radii(blend, robot).max()) if joints else blend.length or 0.0
    return Corner(first, second, segments, segments > 0 and size > 0.0, joints)


def cruise(place: Place) -> tuple[float, float]:
    """The programmed speeds of a motion, [m/s] and [rad/s]; NaN where it has none."""
    speed = place.motion.timing.speed
    if speed is None or isinstance(place.motion, IN_JOINTS):
        return np.nan, np.nan
    return (
        np.nan if speed.length is None else speed.length,
        np.nan if speed.angle is None else speed.angle,
    )


def speeds_around(layout: Layout, flows: Flows) -> Array:
    """The most that is allowed in the blends before and behind each motion, (P, 2) [m/s]: the larger programmed speed of both."""
    own = np.array([cruise(place)[0] for place in layout.places])
    around = np.full((len(own), 2), np.inf)
    for corner in flows.corners:
        both = own[[corner.first, corner.second]]
        if not np.isnan(both).any():
            around[corner.first, 1] = around[corner.second, 0] = both.max()
    return around
