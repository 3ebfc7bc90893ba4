"""Prove that watched items stay in zones, or out of them, along a whole motion, and compute their least
distances from the zones' borders, by bisection.

The motion's time is divided into pieces. A piece is settled if the bounds of `gaps` suffice; otherwise it is
halved. The error of a bound grows with the square of a piece's duration, so a motion along a border needs few
pieces. No breach is missed, however short.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.keeping import Sight, Tilt
from yarclang.cell.model import JointWindow, Unplaced
from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.course import Course
from yarclang.collision.proof import COARSE, KNOWN, SHARE
from yarclang.collision.zones.gaps import depth_inside, least_outside, roughly_outside
from yarclang.collision.zones.moved import Ends, Pieces, Posed, Rates, joints, rates
from yarclang.collision.zones.regions import outside
from yarclang.collision.zones.sights import Bounds
from yarclang.collision.zones.tilts import angles_at, turning
from yarclang.collision.zones.watched import Item
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.collision.zones.windows import room, room_on
from yarclang.collision.zones.workspace import SLACK, TILT_SLACK, Watch
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.shapes import Array

MOST = 500_000
"""Largest number of pieces of time for one zone and item. If more are needed, the zone counts as broken: only
motions that no robot can make need so many.
"""
BLOCK = 2048
"""Number of pieces of time that are examined together."""
Flags = NDArray[np.bool_]


@frozen
class Breach:
    """A zone that is violated during a motion.

    Attributes:
        motion: index of the motion.
        watch: index of the watch (zone and item).
        time: time of the sample at which a violation was first found, which need not be the earliest [s].
    """

    motion: int
    watch: int
    time: float


@frozen(eq=False)
class Kept:
    """The result of a proof for G motions.

    Attributes:
        least: (G,) lower bound of the distances of all watched items from the borders that they must not
            cross [m].
        nearest: (G,) index of the watch (zone and item) that comes nearest to its border; -1 if all stay
            above `KNOWN`.
        when: (G,) time of the sample at which this watch is nearest [s].
        breaches: the violated zones.
    """

    least: Array
    nearest: Rows
    when: Array
    breaches: tuple[Breach, ...]


def kept(scene: Scene, course: Course, spans: NDArray[np.int64], watches: Sequence[Watch]) -> Kept:
    """Prove that watched items stay in their zones, or out of them, and that the arm has the required posture
    in zones that require one.

    Args:
        scene: the bodies of robot and cell.
        course: the segments of all motions.
        spans: (G, 2) for each motion, its first segment and the one after its last; the motions are
            consecutive, and none is empty.
        watches: the zones and the watched items. Slow zones aren't checked here.
    """
    search = _Search(scene, course, spans)
    for number, watch in enumerate(watches):
        if watch.zone.rule != "slow":
            search.look(number, watch)
    return Kept(search.least, search.nearest, search.when, tuple(search.breaches))


class _Search:
    """State and results of the proof that zones are respected."""

    def __init__(self, scene: Scene, course: Course, spans: NDArray[np.int64]) -> None:
        self.scene, self.course, self.spans = scene, course, spans
        self.motion = np.searchsorted(spans[:, 1], np.arange(int(spans[-1, 1])), side="right")
        self.least = np.full(len(spans), np.inf)
        self.best = np.full(len(spans), np.inf)
        self.nearest = np.full(len(spans), -1, dtype=np.int64)
        self.when = np.zeros(len(spans))
        self.breaches: list[Breach] = []
        self.pieces = Pieces.whole(course, int(spans[0, 0]), int(spans[-1, 1]))
        self.ends = Ends(scene, course, self.pieces)
        self.bounds: dict[int, Rates] = {}

    def look(self, number: int, watch: Watch) -> None:
        """Check one zone with its watched item on all motions."""
        region = watch.zone.region
        hit = np.zeros(len(self.spans), dtype=np.bool_)
        if isinstance(region, JointWindow):
            self._window(number, watch, region, hit)
            return
        if isinstance(region, Tilt):
            self._tilt(number, region, hit)
            return
        if isinstance(region, Sight):
            self._sight(number, region, hit)
            return
        item = watch.item
        assert item is not None
        if id(item) not in self.bounds:
            self.bounds[id(item)] = rates(self.scene.chain, self.course, item)
        bounds = self.bounds[id(item)]
        look = self._inside if watch.zone.rule == "allowed" else self._outside
        near = self._rough(watch, item, bounds)
        done = 0
        waiting = [(self.pieces.take(near), self.ends.of(item, near))]
        while waiting:
            go_on()
            pieces, ends = waiting.pop()
            if not len(pieces.segment):
                continue
            found = look(watch, item, bounds, pieces, ends)
            left = self._learn(number, pieces.segment, found, watch.zone.margin, hit)
            done += len(pieces.segment)
            if done > MOST:
                rest = pieces.take(left)
                self._break(number, rest.segment, np.ones(len(left), np.bool_), rest.middle, hit)
                continue
            for part in _blocks(pieces.take(left).halves()):
                begins, stops = (
                    part.posed(item, self.scene, self.course, time) for time in (part.begin, part.end)
                )
                waiting.append((part, (begins, stops)))

    def _rough(self, watch: Watch, item: Item, bounds: Rates) -> Rows:
        """Return the segments for which the ball around the item doesn't prove that the zone is respected;
        record the lower bounds of the other segments.
        """
        region, margin, pieces = watch.zone.region, watch.zone.margin, self.pieces
        assert not isinstance(region, Unplaced)
        # Compute each instant once, although it may be both the end of a segment and the beginning of the
        # next.
        far = outside(region, self.ends.arm.of(item).point(item.middle))
        before, behind = far[self.ends.begins], far[self.ends.stops]
        if watch.zone.rule == "allowed":
            # The signed distance is convex, so it is largest at an end of the chord; add the deviation from
            # the chord (see gaps.py).
            least = -np.maximum(before, behind) - item.bound - bounds.second * pieces.end**2 / 8.0
        else:
            least = (before + behind - bounds.first * pieces.end) / 2.0 - item.bound
        done = least >= max(KNOWN, margin)
        np.minimum.at(self.least, self.motion[pieces.segment[done]], least[done])
        return np.flatnonzero(~done)

    def _inside(
        self, watch: Watch, item: Item, bounds: Rates, pieces: Pieces, ends: tuple[Posed, Posed]
    ) -> tuple[Array, Array, Array]:
        region = watch.zone.region
        assert not isinstance(region, Unplaced)
        # The depth is a concave function along a chord, so it is least at an end. The item's points leave
        # their chords by at most A d^2 / 8, where A bounds their acceleration, and d is the duration of the
        # piece.
        sag = bounds.second[pieces.segment] * (pieces.end - pieces.begin) ** 2 / 8.0
        before, behind = (depth_inside(region, item, posed) for posed in ends)
        seen = np.minimum(before, behind)
        return seen - sag, seen, np.where(before < behind, pieces.begin, pieces.end)

    def _outside(
        self, watch: Watch, item: Item, bounds: Rates, pieces: Pieces, ends: tuple[Posed, Posed]
    ) -> tuple[Array, Array, Array]:
        region, posture = watch.zone.region, watch.zone.posture
        assert not isinstance(region, Unplaced)
        # Bound the distance that any point of the item travels on each piece.
        way = bounds.first[pieces.segment] * (pieces.end - pieces.begin)
        least = roughly_outside(region, item, ends, way)
        seen = np.full(len(least), np.inf)
        open_ = least < max(KNOWN, watch.zone.margin)
        if posture is not None:
            # An item may be in the zone while the arm has the required posture. Therefore it must stay
            # outside only on pieces on which the arm leaves the posture.
            kept_there = (room_on(posture, pieces, self.course)[0] >= -WINDOW_SLACK).all(axis=1)
            least[kept_there] = np.inf
            open_ &= ~kept_there
        near = np.flatnonzero(open_)
        if len(near):
            part = pieces.take(near)
            middle = part.posed(item, self.scene, self.course, part.middle)
            arms = (ends[0].take(near), middle, ends[1].take(near))
            sure, found = least_outside(region, item, part, arms, bounds)
            least[near] = np.maximum(least[near], sure)
            if posture is not None:
                q = joints(self.course, part.segment, part.middle)[0]
                found = np.where((room(posture, q) < -WINDOW_SLACK / 2.0).any(axis=1), found, np.inf)
            seen[near] = found
        return least, seen, pieces.middle

    def _learn(
        self, number: int, segment: Rows, found: tuple[Array, Array, Array], margin: float, hit: Flags
    ) -> Rows:
        """Record the lower bounds of pieces, and return the pieces that are still undecided."""
        least, seen, when = found
        motion = self.motion[segment]
        self._break(number, segment, seen < margin - SLACK / 2.0, when, hit)
        order = np.argsort(-seen, kind="stable")  # the smallest value of a motion is written last
        nearer = order[seen[order] < self.best[motion[order]]]
        self.best[motion[nearer]], self.nearest[motion[nearer]] = seen[nearer], number
        self.when[motion[nearer]] = self.course.begins[segment[nearer]] + when[nearer]
        # A piece is settled if it keeps the margin, and can't change the least distance by more than the
        # allowed error.
        wanted = np.minimum(KNOWN, (1.0 - SHARE) * self.best[motion] - COARSE)
        done = (least >= margin - SLACK) & (least >= wanted)
        np.minimum.at(self.least, motion[done], least[done])
        return np.flatnonzero(~done & ~hit[motion])

    def _window(self, number: int, watch: Watch, window: JointWindow, hit: Flags) -> None:
        """Check a zone of allowed or forbidden joint positions on all motions."""
        pieces = self.pieces
        while len(pieces.segment):
            go_on()
            least, most = room_on(window, pieces, self.course)
            q = joints(self.course, pieces.segment, pieces.middle)[0]
            seen = room(window, q).min(axis=1)
            if watch.zone.rule == "allowed":
                surely = least.min(axis=1)
            else:
                # A position is out of the window if at least one joint is. Its distance from the window is
                # the largest distance of any joint.
                surely, seen = -most.min(axis=1), -seen
            self._break(number, pieces.segment, seen < -WINDOW_SLACK / 2.0, pieces.middle, hit)
            open_ = ~(surely >= -WINDOW_SLACK) & ~hit[self.motion[pieces.segment]]
            pieces = pieces.take(np.flatnonzero(open_)).halves()

    def _tilt(self, number: int, tilt: Tilt, hit: Flags) -> None:
        """Check a zone that limits an axis' angle on all motions, by the angle that the axis can turn in a
        piece of time, and by the second derivative of its direction.
        """
        scene, course, pieces, done = self.scene, self.course, self.pieces, 0
        speed, bend = turning(scene.chain, course)
        while len(pieces.segment):
            go_on()
            long = pieces.end - pieces.begin
            before, behind = (
                angles_at(tilt, scene, joints(course, pieces.segment, time)[0])
                for time in (pieces.begin, pieces.end)
            )
            worst = np.maximum(before, behind)
            # The cosine is below its chord by at most its second derivative times d^2 / 8.
            sag = bend[pieces.segment] * long**2 / 8.0
            by_chord = np.arccos(np.clip(np.cos(worst) - sag, -1.0, 1.0))
            most = np.minimum(by_chord, (before + behind + speed[pieces.segment] * long) / 2.0)
            when = np.where(before > behind, pieces.begin, pieces.end)
            self._break(number, pieces.segment, worst > tilt.limit + TILT_SLACK / 2.0, when, hit)
            open_ = np.flatnonzero(~(most <= tilt.limit + TILT_SLACK) & ~hit[self.motion[pieces.segment]])
            done += len(open_)
            pieces = pieces.take(open_)
            if done > MOST:
                self._break(number, pieces.segment, np.ones(len(open_), np.bool_), pieces.middle, hit)
                return
            pieces = pieces.halves()

    def _sight(self, number: int, sight: Sight, hit: Flags) -> None:
        """Check a zone that keeps a point in a cone on all motions."""
        pieces, done = self.pieces, 0
        bounds = Bounds(sight, self.scene, self.course)
        while len(pieces.segment):
            go_on()
            least, seen, when = bounds.look(pieces)
            self._break(number, pieces.segment, ~(seen >= -TILT_SLACK / 2.0), when, hit)
            open_ = np.flatnonzero(~(least >= -TILT_SLACK) & ~hit[self.motion[pieces.segment]])
            done += len(open_)
            pieces = pieces.take(open_)
            if done > MOST:
                self._break(number, pieces.segment, np.ones(len(open_), np.bool_), pieces.middle, hit)
                return
            pieces = pieces.halves()

    def _break(self, number: int, segment: Rows, broken: Flags, when: Array, hit: Flags) -> None:
        """Record, for each motion, the sample at which the zone is first found broken."""
        for row in np.flatnonzero(broken).tolist():
            motion = int(self.motion[segment[row]])
            if not hit[motion]:
                hit[motion] = True
                time = float(self.course.begins[segment[row]] + when[row])
                self.breaches.append(Breach(motion, number, time))


def _blocks(pieces: Pieces) -> Iterator[Pieces]:
    for start in range(0, len(pieces.segment), BLOCK):
        yield pieces.take(np.arange(start, min(start + BLOCK, len(pieces.segment))))
