"""How fast what zones watch goes inside of them: the largest speed on whole motions, at every instant, by halving.

The velocity of a point lies, within d seconds, no farther than its third derivative times d^2 / 8 from the straight line between what it is before and behind, and the
length of a vector is largest at an end of a line. So the bound of a piece is sharp long before the piece is short.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

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
"""The largest speed is told to within this share of it."""


@frozen(eq=False)
class Fastest:
    """The largest speed (G,) of an item on each motion while it is in a zone [m/s], a proved bound; 0 where it never is. `segment` (G,) is where, -1 for nowhere,
    and `time` (G,) when: the middle of the piece that it belongs to [s].
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
    """How fast an item goes at most in a slow zone.

    Args:
        scene: the bodies of robot and cell.
        course: segments, of all motions.
        spans: (G, 2) the segments, from and up to, of each motion, one behind the other; none is empty.
        watch: the zone and the item; its margin counts as inside.
        least: speeds up to this one don't matter: they may be told as none, or as this one [m/s].
        beyond: the zone is larger by this [m].
        whole: the arm along these motions, where several watches are asked.
        sharp: to within which share of it the largest speed is told.
        stops: where all motions are known to be faster than `least`, how much faster doesn't matter, and only some speed that they have is told.
    """
    shared = whole or Whole(scene, course, spans)
    return _Search(shared, spans, watch, (least, beyond, sharp), stops=stops).made()


def may_enter(scene: Scene, ways: tuple[Array, Array], step: Array, watches: Sequence[Watch]) -> Flags:
    """Whether items may get into their zones on short ways, (W, R).

    Args:
        scene: the bodies of robot and cell.
        ways: the joint positions at their beginnings and at their ends, (R, n) each [rad or m].
        step: (R, n) how far each joint goes on them at most, forth and back.
        watches: of slow zones.
    """
    begin, end = ways
    # a course of one second a way
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
            way = rates(scene.chain, course, item).first
            near = roughly_outside(region, item, ends.of(item), way)
            found[number] = near <= watch.zone.margin + _ASIDE
    return found


_ASIDE = 1e-3
"""How far the arm may be beside the way that was looked at [m]."""


class _Search:
    """One watch on all motions."""

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
        """Halve until all is settled."""
        # no point of it can be faster, wherever the arm is; nor where it is far away
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
        # what was passed over is no faster than the best and this share of it
        speed = np.where(self.segment >= 0, self.best * (1.0 + self.sharp), 0.0)
        return Fastest(speed, self.segment, self.time)

    def _look(self, pieces: Pieces, ends: tuple[Posed, Posed]) -> tuple[Pieces, tuple[Posed, Posed] | None]:
        """What is left of pieces, with the arm at their ends."""
        long, segment = pieces.end - pieces.begin, pieces.segment
        bound = (
            np.maximum(*(arm.speed(self.item) for arm in ends)) + self.bounds.third[segment] * long**2 / 8.0
        )
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
        # too short to tell whether they are in the zone: they count as if they were
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
        """Which whole segments are outside of the zone, from balls."""
        region, pieces = self.watch.zone.region, self.pieces
        if isinstance(region, JointWindow):
            return np.zeros(len(pieces.segment), dtype=np.bool_)
        ends = self.whole.ends
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
        way = self.bounds.first[pieces.segment] * (pieces.end - pieces.begin)
        far: NDArray[np.bool_] = roughly_outside(region, self.item, ends, way) > self.margin
        return far

    def _where(
        self, pieces: Pieces, arms: tuple[Posed, Posed, Posed]
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which pieces are outside of the zone all along, and which are in it in their middles."""
        region = self.watch.zone.region
        if isinstance(region, JointWindow):
            q = joints(self.course, pieces.segment, pieces.middle)[0]
            return np.zeros(len(q), dtype=np.bool_), room(region, q).min(axis=1) >= -WINDOW_SLACK
        least, seen = least_outside(region, self.item, pieces, arms, self.bounds)
        return least > self.margin, seen <= self.margin + SLACK / 2.0

    def _learn(self, pieces: Pieces, speed: Array) -> None:
        """Keep the largest speed of each motion, and where it is."""
        motion = self.motion[pieces.segment]
        order = np.argsort(speed, kind="stable")  # the largest is written last
        larger = order[speed[order] > self.best[motion[order]]]
        at = motion[larger]
        self.best[at], self.segment[at] = speed[larger], pieces.segment[larger]
        self.time[at] = self.course.begins[pieces.segment[larger]] + pieces.middle[larger]
