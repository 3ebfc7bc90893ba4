"""Measure where a point is in a cone that a zone prescribes, and bound how fast the direction from the cone's
apex to the point changes.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.keeping import Sight
from yarclang.collision.course import Course
from yarclang.collision.scene import Scene
from yarclang.collision.zones.moved import Arm, Pieces, joints, rates
from yarclang.collision.zones.tilts import turning
from yarclang.collision.zones.watched import point_item
from yarclang.frozen import frozen
from yarclang.robot.model import Chain
from yarclang.shapes import Array


@frozen(eq=False)
class Aim:
    """Where a point is relative to a cone, at P instants.

    Attributes:
        angle: (P,) angle between the cone's axis and the direction from its apex to the point [rad].
        distance: (P,) distance of the point from the apex [m].
        way: (3, P) vector from the apex to the point [m].
    """

    angle: Array
    distance: Array
    way: Array


def aimed(sight: Sight, chain: Chain, turn: Array, shift: Array) -> Aim:
    """Return where the point is relative to the cone at P instants.

    Args:
        sight: the cone and the point.
        chain: the arm.
        turn: (3, 3, P) rotations of the flange from its pose with all joints at zero.
        shift: (3, P) translations of the flange from this pose [m].
    """
    carried = np.matmul(_placed(sight, chain), turn) + shift
    spot = np.array(sight.spot)[:, None]
    if sight.is_carried:
        way = spot - carried
        axis = np.matmul(chain.base_from_flange[:3, :3] @ np.array(sight.axis), turn)
    else:
        way, axis = carried - spot, np.array(sight.axis)[:, None]
    across = np.cross(axis.T, way.T).T
    angle = np.arctan2(np.sqrt((across**2).sum(axis=0)), (axis * way).sum(axis=0))
    return Aim(angle, np.sqrt((way**2).sum(axis=0)), way)


def aimed_at(sight: Sight, scene: Scene, q: Array) -> Aim:
    """Return where the point is relative to the cone at joint positions (P, n) [rad or m]."""
    arm = Arm.at(scene, q)
    return aimed(sight, scene.chain, arm.turn[-1], arm.shift[-1])


def reserve(sight: Sight, aim: Aim) -> Array:
    """Return how far the point is from leaving the cone or its range of distances, (P,): the least of the
    reserves of the angle [rad] and of both ends of the range [m].
    """
    least: Array = np.minimum(
        sight.limit - aim.angle, np.minimum(aim.distance - sight.near, sight.far - aim.distance)
    )
    return least


class Bounds:
    """Bounds on how near a point comes to leaving its cone, between the ends of pieces of a motion's time."""

    def __init__(self, sight: Sight, scene: Scene, course: Course) -> None:
        chain = scene.chain
        self._sight, self._scene, self._course = sight, scene, course
        point = point_item(f"{sight.own}", chain.size, _placed(sight, chain))
        self._moved = rates(chain, course, point)
        zero = np.zeros(len(course.x))
        self._turned = turning(chain, course) if sight.is_carried else (zero, zero)

    def look(self, pieces: Pieces) -> tuple[Array, Array, Array]:
        """Return three values for each piece of a motion's time: a lower bound of the reserve on the piece
        (P,), the smaller reserve of its two ends (P,), and the time of that end after the segment's start
        (P,) [s].
        """
        sight, long, at = self._sight, pieces.end - pieces.begin, pieces.segment
        before, after = (
            aimed_at(sight, self._scene, joints(self._course, at, time)[0])
            for time in (pieces.begin, pieces.end)
        )
        here, there = reserve(sight, before), reserve(sight, after)
        speed, strength = self._moved.first[at], self._moved.second[at]
        turn, bend = self._turned[0][at], self._turned[1][at]
        sag = strength * long**2 / 8.0
        # the point's way differs from its chord by at most `sag`
        step = after.way - before.way
        size = (step**2).sum(axis=0)
        share = np.clip(-(before.way * step).sum(axis=0) / np.where(size > 0.0, size, 1.0), 0.0, 1.0)
        chord = np.sqrt(((before.way + share * step) ** 2).sum(axis=0))
        both = before.distance + after.distance
        near = np.maximum((both - speed * long) / 2.0, chord - sag)
        far = np.minimum((both + speed * long) / 2.0, np.maximum(before.distance, after.distance) + sag)
        # the direction is undefined at the apex: nothing is known there of its angle
        is_off = near > 0.0
        nearest = np.where(is_off, near, 1.0)
        swing = speed / nearest
        second = bend + 2.0 * turn * swing + strength / nearest + 2.0 * swing**2
        worst = np.maximum(before.angle, after.angle)
        by_chord = np.arccos(np.clip(np.cos(worst) - second * long**2 / 8.0, -1.0, 1.0))
        most = np.minimum(by_chord, (before.angle + after.angle + (turn + swing) * long) / 2.0)
        most = np.where(is_off, most, np.pi)
        least = np.minimum(sight.limit - most, np.minimum(near - sight.near, sight.far - far))
        return least, np.minimum(here, there), np.where(here < there, pieces.begin, pieces.end)


def _placed(sight: Sight, chain: Chain) -> Array:
    """Return the position (3,) in {B}, with all joints at zero [m], of what the flange carries: the apex of
    the cone, or the point.
    """
    placed: Array = chain.base_from_flange[:3, :3] @ np.array(sight.own) + chain.base_from_flange[:3, 3]
    return placed
