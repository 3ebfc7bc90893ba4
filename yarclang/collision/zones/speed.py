"""How fast what zones watch goes inside of them: the largest speed on whole motions, at every instant, by halving.

The velocity of a point lies, within d seconds, no farther than its third derivative times d^2 / 8 from the straight line between what it is before and behind, and the
length of a vector is largest at an end of a line. So the bound of a piece is sharp long before the piece is short.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import JointWindow
from yarclang.collision.course import Course
from yarclang.collision.scene import Rows, Scene
from yarclang.collision.zones.gaps import least_outside, roughly_outside
from yarclang.collision.zones.moved import Arm, Pieces, Rates, arms_at_ends, joints, rates
from yarclang.collision.zones.watched import Item
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.collision.zones.windows import room, room_on
from yarclang.collision.zones.workspace import SLACK, Watch
from yarclang.shapes import Array

SHARP = 2e-4
"""The largest speed is told to within this share of it."""


@dataclass(frozen=True, slots=True, eq=False)
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
) -> Fastest:
    """How fast an item goes at most in a slow zone.

    Args:
        scene: the bodies of robot and cell.
        course: segments, of all motions.
        spans: (G, 2) the segments, from and up to, of each motion, one behind the other; none is empty.
        watch: the zone and the item; its margin counts as inside.
        least: speeds up to this one don't matter: they may be told as none, or as this one [m/s].
        beyond: the zone is larger by this [m].
        sharp: to within which share of it the largest speed is told.
        stops: where all motions are known to be faster than `least`, how much faster doesn't matter, and only some speed that they have is told.
    """
    return _Search(scene, course, spans, watch, (least, beyond, sharp), stops=stops).made()


class _Search:
    """One watch on all motions."""

    def __init__(
        self,
        scene: Scene,
        course: Course,
        spans: NDArray[np.int64],
        watch: Watch,
        amounts: tuple[float, float, float],
        *,
        stops: bool,
    ) -> None:
        least, beyond, self.sharp = amounts
        assert watch.item is not None
        self.scene, self.course, self.watch = scene, course, watch
        self.item: Item = watch.item
        self.bounds: Rates = rates(scene.chain, course, self.item)
        self.motion = np.searchsorted(spans[:, 1], np.arange(int(spans[-1, 1])), side="right")
        self.pieces = Pieces.whole(course, int(spans[0, 0]), int(spans[-1, 1]))
        self.margin = watch.zone.margin + beyond
        self.least, self.stops = least, stops
        self.best = np.full(len(spans), least)
        self.segment = np.full(len(spans), -1, dtype=np.int64)
        self.time = np.zeros(len(spans))

    def made(self) -> Fastest:
        """Halve until all is settled."""
        # no point of it can be faster, wherever the arm is
        (rows,) = np.nonzero(self.bounds.first[self.pieces.segment] > self.least)
        pieces = self.pieces.take(rows)
        ends: tuple[Arm, Arm] | None = None
        if len(rows):
            ends = arms_at_ends(self.scene, self.course, pieces, moving=True)
        while ends is not None:
            pieces, ends = self._look(pieces, ends)
            if self.stops and (self.segment >= 0).all():
                break
        # what was passed over is no faster than the best and this share of it
        speed = np.where(self.segment >= 0, self.best * (1.0 + self.sharp), 0.0)
        return Fastest(speed, self.segment, self.time)

    def _look(self, pieces: Pieces, ends: tuple[Arm, Arm]) -> tuple[Pieces, tuple[Arm, Arm] | None]:
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
        middle = pieces.arm(self.scene, self.course, pieces.middle, moving=True)
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

    def _surely_outside(self, pieces: Pieces, ends: tuple[Arm, Arm]) -> NDArray[np.bool_]:
        region = self.watch.zone.region
        if isinstance(region, JointWindow):
            most = room_on(region, pieces, self.course)[1]
            apart: NDArray[np.bool_] = most.min(axis=1) < -WINDOW_SLACK
            return apart
        way = self.bounds.first[pieces.segment] * (pieces.end - pieces.begin)
        far: NDArray[np.bool_] = roughly_outside(region, self.item, ends, way) > self.margin
        return far

    def _where(
        self, pieces: Pieces, arms: tuple[Arm, Arm, Arm]
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
