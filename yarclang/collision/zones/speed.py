"""Bound the speed of watched items inside of slow zones: compute the largest speed on whole motions, over all
instants, by bisection.

On an interval of d seconds, the velocity of a point is at most J d² / 8 from the chord between the velocities
at the ends, where J bounds the third derivative of the point's position. On a chord, the length of a vector
is largest at an end. The bound of the speed is therefore sharp on pieces of time that are still long.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.keeping import Pointed
from yarclang.cell.model import JointWindow
from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.course import Course
from yarclang.collision.zones.gaps import least_outside, roughly_outside
from yarclang.collision.zones.moved import Ends, Pieces, Posed, Rates, Whole, joints, rates
from yarclang.collision.zones.regions import outside
from yarclang.collision.zones.watched import Item
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.collision.zones.windows import room, room_on
from yarclang.collision.zones.workspace import SLACK, Watch
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.shapes import Array

Flags = NDArray[np.bool_]

SHARP = 2e-4
"""Relative accuracy of the largest speed."""


@frozen(eq=False)
class Fastest:
    """The largest speed that an item has on each of G motions while it is in a zone.

    Attributes:
        speed: (G,) proved bound of the speed [m/s]; 0 if the item is never in the zone.
        segment: (G,) segment of the largest speed; -1 if the item is never in the zone.
        time: (G,) middle of the piece of time in which the largest speed occurs [s].
    """

    speed: Array
    segment: Rows
    time: Array


def fastest_inside(
    scene: Scene,
    course: Course,
    spans: NDArray[np.int64],
    watch: Watch,
    *,
    least: float = 0.0,
    beyond: float = 0.0,
    stops: bool = False,
    sharp: float = SHARP,
    whole: Whole | None = None,
) -> Fastest:
    """Compute the largest speed that an item has in a slow zone, on each motion.

    Args:
        scene: the bodies of robot and cell.
        course: the segments of all motions.
        spans: (G, 2) for each motion, its first segment and the one after its last; the motions are
            consecutive, and none is empty.
        watch: the zone and the item; the zone's margin counts as inside.
        least: speed of interest [m/s]. Normally, a motion on which the item is never faster counts as one on
            which the item is never in the zone (segment -1).
        beyond: distance by which the zone is enlarged [m].
        stops: True to end as soon as all motions are known to be faster than `least`. The result is then only
            some speed that occurs on them.
        sharp: relative accuracy of the largest speed.
        whole: the arm along these motions, to share it between several watches; or None.
    """
    shared = whole or Whole(scene, course, spans)
    return _Search(shared, spans, watch, (least, beyond, sharp), stops=stops).made()


def may_enter(scene: Scene, ways: tuple[Array, Array], step: Array, watches: Sequence[Watch]) -> Flags:
    """Return a mask (W, R) of the watched items that may enter their zones during short joint motions.

    Args:
        scene: the bodies of robot and cell.
        ways: the joint positions at the beginnings and at the ends of R motions, (R, n) each [rad or m].
        step: (R, n) the largest distance that each joint travels on them, back and forth.
        watches: the W slow zones and their items.
    """
    begin, end = ways
    # Make a course in which each motion takes one second.
    still = np.zeros(begin.shape)
    course = Course.of(begin, end - begin, still, still, np.ones(len(begin)), step)
    ends = Ends(scene, course, Pieces.whole(course, 0, len(begin)))
    found = np.empty((len(watches), len(begin)), dtype=np.bool_)
    for number, watch in enumerate(watches):
        region, item = watch.zone.region, watch.item
        assert item is not None
        if isinstance(region, JointWindow):
            inner = np.maximum(room(region, begin), room(region, end))
            found[number] = (inner >= -step).all(axis=1)
        else:
            assert not isinstance(region, Pointed)  # zones of directions and cones never limit the speed
            # Each motion takes one second, so the bound of the speed is also a bound of the distance
            # travelled.
            way = rates(scene.chain, course, item).first
            near = roughly_outside(region, item, ends.of(item), way)
            found[number] = near <= watch.zone.margin + _ASIDE
    return found


_ASIDE = 1e-3
"""Distance by which zones are enlarged [m], since the arm may leave the examined joint motion by up to this
distance.
"""


class _Search:
    """Search for the largest speed of one item in its slow zone, on all motions."""

    def __init__(
        self,
        whole: Whole,
        spans: NDArray[np.int64],
        watch: Watch,
        amounts: tuple[float, float, float],
        *,
        stops: bool,
    ) -> None:
        least, beyond, self.sharp = amounts
        assert watch.item is not None
        self.scene, self.course, self.watch, self.whole = whole.scene, whole.course, watch, whole
        self.item: Item = watch.item
        self.bounds: Rates = rates(self.scene.chain, self.course, self.item)
        self.motion = np.searchsorted(spans[:, 1], np.arange(int(spans[-1, 1])), side="right")
        self.pieces = whole.pieces
        self.margin = watch.zone.margin + beyond
        self.least, self.stops = least, stops
        self.best = np.full(len(spans), least)
        self.segment = np.full(len(spans), -1, dtype=np.int64)
        self.time = np.zeros(len(spans))

    def made(self) -> Fastest:
        """Halve pieces of time until all are decided, and return the largest speeds."""
        # Drop segments on which no point can be faster than `least`, and segments far from the zone.
        (rows,) = np.nonzero(self.bounds.first[self.pieces.segment] > self.least)
        if len(rows):
            rows = rows[~self._surely_far()[rows]]
        pieces = self.pieces.take(rows)
        ends = self.whole.ends.of(self.item, rows) if len(rows) else None
        while ends is not None:
            go_on()
            pieces, ends = self._look(pieces, ends)
            if self.stops and (self.segment >= 0).all():
                break
        # The pieces that were dropped may be faster than the fastest known piece, but by at most the share
        # `sharp`.
        speed = np.where(self.segment >= 0, self.best * (1.0 + self.sharp), 0.0)
        return Fastest(speed, self.segment, self.time)

    def _look(self, pieces: Pieces, ends: tuple[Posed, Posed]) -> tuple[Pieces, tuple[Posed, Posed] | None]:
        """Examine pieces of time, given the arm at their ends; return the halves of the pieces that are still
        undecided, with the arm at their ends.
        """
        long, segment = pieces.end - pieces.begin, pieces.segment
        bound = (
            np.maximum(*(arm.speed(self.item) for arm in ends)) + self.bounds.third[segment] * long**2 / 8.0
        )
        # Only pieces that may exceed the best known speed by more than the accuracy are examined.
        quick = bound > self.best[self.motion[segment]] * (1.0 + self.sharp)
        (rows,) = np.nonzero(quick & ~self._surely_outside(pieces, ends))
        if not len(rows):
            return pieces, None
        pieces, bound = pieces.take(rows), bound[rows]
        middle = pieces.posed(self.item, self.scene, self.course, pieces.middle, moving=True)
        arms = ends[0].take(rows), middle, ends[1].take(rows)
        out, in_middle = self._where(pieces, arms)
        (seen,) = np.nonzero(in_middle)
        self._learn(pieces.take(seen), middle.take(seen).speed(self.item))
        # Pieces too short to decide if they are in the zone count as inside.
        still = self.bounds.first[pieces.segment] * (pieces.end - pieces.begin) <= SLACK
        (rows,) = np.nonzero(~out & still)
        self._learn(pieces.take(rows), bound[rows])
        (left,) = np.nonzero(
            ~out & ~still & (bound > self.best[self.motion[pieces.segment]] * (1.0 + self.sharp))
        )
        if not len(left):
            return pieces, None
        begin, half, end = (arm.take(left) for arm in arms)
        return pieces.take(left).halves(), (begin.beside(half), half.beside(end))

    def _surely_far(self) -> Flags:
        """Return a mask of the whole segments on which the ball around the item stays outside of the zone."""
        region, pieces = self.watch.zone.region, self.pieces
        if isinstance(region, JointWindow):
            return np.zeros(len(pieces.segment), dtype=np.bool_)
        assert not isinstance(region, Pointed)
        ends = self.whole.ends
        # If the middle of the ball is no faster than V, its signed distance from the zone changes by at most
        # V d on a segment of d seconds. So the distance is at least (a + b - V d) / 2, with its values a and
        # b at both ends.
        far = outside(region, ends.arm.of(self.item).point(self.item.middle))
        way = self.bounds.first[pieces.segment] * pieces.end
        apart: Flags = (far[ends.begins] + far[ends.stops] - way) / 2.0 - self.item.bound > self.margin
        return apart

    def _surely_outside(self, pieces: Pieces, ends: tuple[Posed, Posed]) -> NDArray[np.bool_]:
        region = self.watch.zone.region
        if isinstance(region, JointWindow):
            most = room_on(region, pieces, self.course)[1]
            apart: NDArray[np.bool_] = most.min(axis=1) < -WINDOW_SLACK
            return apart
        assert not isinstance(region, Pointed)
        way = self.bounds.first[pieces.segment] * (pieces.end - pieces.begin)
        far: NDArray[np.bool_] = roughly_outside(region, self.item, ends, way) > self.margin
        return far

    def _where(
        self, pieces: Pieces, arms: tuple[Posed, Posed, Posed]
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return two masks of the pieces of time: those entirely outside of the zone, and those with the item
        inside in their middle.
        """
        region = self.watch.zone.region
        if isinstance(region, JointWindow):
            q = joints(self.course, pieces.segment, pieces.middle)[0]
            return np.zeros(len(q), dtype=np.bool_), room(region, q).min(axis=1) >= -WINDOW_SLACK
        assert not isinstance(region, Pointed)
        least, seen = least_outside(region, self.item, pieces, arms, self.bounds)
        return least > self.margin, seen <= self.margin + SLACK / 2.0

    def _learn(self, pieces: Pieces, speed: Array) -> None:
        """Record the largest speed of each motion, and where it occurs."""
        motion = self.motion[pieces.segment]
        order = np.argsort(speed, kind="stable")  # the largest speed of a motion is written last
        larger = order[speed[order] > self.best[motion[order]]]
        at = motion[larger]
        self.best[at], self.segment[at] = speed[larger], pieces.segment[larger]
        self.time[at] = self.course.begins[pieces.segment[larger]] + pieces.middle[larger]
