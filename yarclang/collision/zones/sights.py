"""Measure the position of a point relative to a cone that a zone prescribes, and bound the changes of the
direction from the cone's apex to the point.
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
    """The position of a point relative to a cone, at P instants.

    Attributes:
        angle: (P,) angle between the cone's axis and the direction from its apex to the point [rad].
        distance: (P,) distance of the point from the apex [m].
        way: (3, P) vector from the apex to the point [m].
    """

    angle: Array
    distance: Array
    way: Array


def aimed(sight: Sight, chain: Chain, turn: Array, shift: Array) -> Aim:
    """Return the position of the point relative to the cone at P instants.

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
    # atan2 of cross and dot product is accurate near 0 and pi, where arccos of the dot product is not.
    across = np.cross(axis.T, way.T).T
    angle = np.arctan2(np.sqrt((across**2).sum(axis=0)), (axis * way).sum(axis=0))
    return Aim(angle, np.sqrt((way**2).sum(axis=0)), way)


def aimed_at(sight: Sight, scene: Scene, q: Array) -> Aim:
    """Return the position of the point relative to the cone at joint positions (P, n) [rad or m]."""
    arm = Arm.at(scene, q)
    return aimed(sight, scene.chain, arm.turn[-1], arm.shift[-1])


def reserve(sight: Sight, aim: Aim) -> Array:
    """Return the reserve (P,) of the point before it leaves the cone or its range of distances: the least of
    the reserves of the angle [rad] and of both ends of the range [m].
    """
    least: Array = np.minimum(
        sight.limit - aim.angle, np.minimum(aim.distance - sight.near, sight.far - aim.distance)
    )
    return least


class Bounds:
    """Lower bounds of a point's reserve in its cone (see `reserve`), at all instants of pieces of a motion's
    time.
    """

    def __init__(self, sight: Sight, scene: Scene, course: Course) -> None:
        chain = scene.chain
        self._sight, self._scene, self._course = sight, scene, course
        point = point_item(f"{sight.own}", chain.size, _placed(sight, chain))
        self._moved = rates(chain, course, point)
        zero = np.zeros(len(course.x))
        self._turned = turning(chain, course) if sight.is_carried else (zero, zero)

    def look(self, pieces: Pieces) -> tuple[Array, Array, Array]:
        """Return three arrays (P,), with one value for each piece of a motion's time: a lower bound of the
        reserve at all instants of the piece; the reserve at that end of the piece where it is smaller; and
        the time of this end after the segment's start [s].
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
        # The vector from the apex to the point differs from its chord by at most `sag`.
        step = after.way - before.way
        size = (step**2).sum(axis=0)
        # Find the point of the chord nearest to the apex: the apex projected onto the chord.
        share = np.clip(-(before.way * step).sum(axis=0) / np.where(size > 0.0, size, 1.0), 0.0, 1.0)
        chord = np.sqrt(((before.way + share * step) ** 2).sum(axis=0))
        both = before.distance + after.distance
        # Bound the least and the largest distance from the apex. If the point is no faster than V, the
        # distance changes by at most V d on a piece of d seconds. It differs from the distance of the chord
        # by at most `sag`.
        near = np.maximum((both - speed * long) / 2.0, chord - sag)
        far = np.minimum((both + speed * long) / 2.0, np.maximum(before.distance, after.distance) + sag)
        # At the apex, the direction to the point is undefined, so nothing is known of its angle.
        is_off = near > 0.0
        nearest = np.where(is_off, near, 1.0)
        swing = speed / nearest
        # Bound the second derivative of the cosine between the axis a and the direction u = v / r to the
        # point, where v is the vector from the apex to the point, and r its length: |a''| + 2 |a'| |u'| +
        # |u''|. If the point's speed is at most V and its acceleration at most A, then |u'| <= V / r and
        # |u''| <= A / r + 2 V^2 / r^2.
        second = bend + 2.0 * turn * swing + strength / nearest + 2.0 * swing**2
        worst = np.maximum(before.angle, after.angle)
        by_chord = np.arccos(np.clip(np.cos(worst) - second * long**2 / 8.0, -1.0, 1.0))
        # The angle changes no faster than the axis turns plus the direction turns.
        most = np.minimum(by_chord, (before.angle + after.angle + (turn + swing) * long) / 2.0)
        most = np.where(is_off, most, np.pi)
        least = np.minimum(sight.limit - most, np.minimum(near - sight.near, sight.far - far))
        return least, np.minimum(here, there), np.where(here < there, pieces.begin, pieces.end)


def _placed(sight: Sight, chain: Chain) -> Array:
    """Return the position (3,) [m] of the carried point in {B} with all joints at zero. The carried point is
    the cone's apex if the flange carries the cone, otherwise the point that must stay in the cone.
    """
    placed: Array = chain.base_from_flange[:3, :3] @ np.array(sight.own) + chain.base_from_flange[:3, 3]
    return placed
