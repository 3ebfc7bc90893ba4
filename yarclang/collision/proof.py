"""Prove that bodies stay apart along a whole motion, and compute their least distances, by conservative
advancement with bisection.

A motion's time is divided into pieces, and each piece is examined at its middle. The distance of two bodies
there, less the largest distance that they can move relative to each other towards the ends of the piece, is a
lower bound on the whole piece. If that isn't enough, the piece is halved. So no obstacle is missed, however
thin. Three bounds are tried, from cheap to exact: spheres and boxes on whole arrays, then the library coal.
If the distance suffices in the middle but the bodies move too far, a plane between the bodies is tried
(planes.py): most bodies that pass near each other move along such a plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.course import Course
from yarclang.collision.placing import Placed, box_gaps, distances, place, relative, sphere_gaps
from yarclang.collision.planes import least_gap, proved_gaps
from yarclang.collision.travel import accelerations, travel
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.shapes import Array

SLACK = 1e-5
"""Bodies count as too near if their distance is less than the margin plus this length [m], since a smaller
distance isn't proved.
"""
RESOLUTION = 2e-4
"""Relative motion of two bodies on a piece of time below which the piece isn't halved any further [m].

Bodies that may still get nearer than their margin on such a piece count as too near.
"""
KNOWN = 0.1
"""Distance [m] above which the proof stops: the distance of two bodies is then only known to be larger."""
SHARE, COARSE = 0.1, 1e-3
"""Allowed error of the smallest distance: the share `SHARE` of the distance plus the length `COARSE` [m]."""
FIRST = 0.08
"""Largest motion of a joint on a piece of a motion's time before any piece is halved [rad or m]."""
BLOCK = 2048
"""Number of pieces of time that are examined together."""


@frozen
class Meeting:
    """A pair of bodies that comes too close during a motion.

    Usually, `distance` is less than the margin plus `SLACK`. Otherwise the pair couldn't be decided in
    reasonable time: the distance may become less than the margin on a piece of time in which the bodies move
    by less than `RESOLUTION`.

    Attributes:
        motion: index of the motion.
        pair: index of the pair.
        time: time of the sample at which the pair was first found too close [s]; not always the earliest.
        distance: distance of the bodies at this time [m].
    """

    motion: int
    pair: int
    time: float
    distance: float


@frozen(eq=False)
class Clearances:
    """The result of a proof for G motions, and for three kinds of pairs.

    The kinds are: two bodies of the robot, pairs with a body of the cell, and pairs that may touch.

    Attributes:
        least: (G, 3) lower bound of the distances of all pairs of a kind [m].
        nearest: (G, 3) index of the pair that comes nearest; -1 if all distances stay above `KNOWN`.
        meetings: the pairs that come too near.
    """

    least: Array
    nearest: Rows
    meetings: tuple[Meeting, ...]


def clearances(
    scene: Scene, course: Course, spans: NDArray[np.int64], own: Sequence[Rows] | None = None
) -> Clearances:
    """Compute lower bounds of the distances of all pairs of bodies along motions.

    Args:
        scene: the bodies and pairs.
        course: the segments of all motions.
        spans: (G, 2) for each motion, its first segment and the one after its last; no motion is empty.
        own: for each motion the pairs to examine; None for all.
    """
    search = _Search(scene, course, len(spans))
    pieces = _first_pieces(course, spans)
    every = np.arange(len(scene.pairs.first))
    count = len(pieces.begin)
    if own is None:
        piece, pair = np.repeat(np.arange(count), len(every)), np.tile(every, count)
    else:
        chosen = [own[motion] for motion in pieces.motion.tolist()]
        piece = np.repeat(np.arange(count), [len(rows) for rows in chosen])
        pair = np.concatenate(chosen) if chosen else every[:0]
    while len(piece):
        left = [
            search.look(pieces, piece[rows], pair[rows]) for rows in _blocks(piece, count=len(pieces.begin))
        ]
        piece, pair = (np.concatenate([part[side] for part in left]) for side in (0, 1))
        # Halve each piece with an undecided pair once; its pairs are examined again on both halves.
        halved, at = np.unique(piece, return_inverse=True)
        pieces = pieces.halves(halved)
        piece = np.concatenate([2 * at, 2 * at + 1])
        pair = np.concatenate([pair, pair])
        order = np.argsort(piece, kind="stable")
        piece, pair = piece[order], pair[order]
    return search.answer()


@frozen(eq=False)
class _Pieces:
    """Pieces of the time of motions: from `begin` to `end` (P,) [s], and the motion of each piece."""

    begin: Array
    end: Array
    motion: Rows

    def halves(self, rows: Rows) -> _Pieces:
        """Return both halves of some pieces; the two halves of a piece are next to each other."""
        begin, end = self.begin[rows], self.end[rows]
        middle = (begin + end) / 2.0
        return _Pieces(
            np.stack([begin, middle], axis=1).ravel(),
            np.stack([middle, end], axis=1).ravel(),
            np.repeat(self.motion[rows], 2),
        )


@frozen(eq=False)
class _Pairs:
    """R pairs of bodies, each on a piece of a motion's time, (R,) each.

    Attributes:
        piece: index of the piece.
        pair: index of the pair.
        motion: index of the motion.
        kind: kind of the pair, as in `Clearances`.
        apart: upper bound of the relative motion of the two bodies from the middle of the piece to any other
            instant of it [m].
        nearer: upper bound of the decrease of their distance from the middle to any other instant [m].
        gap: lower bound of their distance in the middle of the piece [m].
    """

    piece: Rows
    pair: Rows
    motion: Rows
    kind: Rows
    apart: Array
    nearer: Array
    gap: Array

    def take(self, rows: Rows) -> _Pairs:
        return _Pairs(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def _first_pieces(course: Course, spans: Rows) -> _Pieces:
    begin, end = course.begins[spans[:, 0]], course.begins[spans[:, 1]]
    way = (course.way[spans[:, 1]] - course.way[spans[:, 0]]).max(axis=1)
    # Begin with equal pieces on which no joint moves by more than about `FIRST`.
    count = np.maximum(np.ceil(way / FIRST), 1.0).astype(np.int64)
    motion = np.repeat(np.arange(len(spans)), count)
    number = np.arange(len(motion)) - np.repeat(np.cumsum(count) - count, count)
    step = ((end - begin) / count)[motion]
    return _Pieces(begin[motion] + number * step, begin[motion] + (number + 1) * step, motion)


def _blocks(piece: Rows, count: int) -> list[slice]:
    """Return slices of the rows, which are sorted by their pieces, so that each slice has about `BLOCK`
    pieces.
    """
    cuts = np.searchsorted(piece, np.arange(0, count + BLOCK, BLOCK))
    return [slice(a, b) for a, b in zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True) if b > a]


class _Search:
    """State and results of the proof that pairs of bodies stay apart."""

    def __init__(self, scene: Scene, course: Course, count: int) -> None:
        self.scene, self.course = scene, course
        self.kinds = np.where(scene.pairs.touching, 2, scene.pairs.of_cell.astype(np.int64))
        self.best = np.full((count, 3), np.inf)
        self.least = np.full((count, 3), np.inf)
        self.nearest = np.full((count, 3), -1, dtype=np.int64)
        self.hit = np.zeros((count, len(scene.pairs.first)), dtype=np.bool_)
        self.meetings: list[Meeting] = []

    def answer(self) -> Clearances:
        return Clearances(self.least, self.nearest, tuple(self.meetings))

    def look(self, pieces: _Pieces, piece: Rows, pair: Rows) -> tuple[Rows, Rows]:
        """Examine R pairs of bodies, each on a piece of time, and return the pieces and pairs that are
        still undecided.
        """
        go_on()
        scene, base = self.scene, int(piece[0])
        chosen = slice(base, int(piece[-1]) + 1)
        begin, end = pieces.begin[chosen], pieces.end[chosen]
        middle = (begin + end) / 2.0
        at = piece - base
        gone = [self.course.gone(time) for time in (begin, middle, end)]
        placed = place(scene, self.course.at(middle))
        # From the middle to any instant of the piece, a joint moves by at most its travel in that half of the
        # piece in which it travels more.
        moves = travel(placed, np.maximum(gone[1] - gone[0], gone[2] - gone[1]))
        apart = moves[scene.boxes.joint[scene.pairs.first[pair]], scene.pairs.second[pair], at]
        motion = pieces.motion[piece]
        # From cheap to exact: spheres first, then boxes, then coal for the pairs that are still undecided.
        rows = _Pairs(at, pair, motion, self.kinds[pair], apart, apart, sphere_gaps(placed, at, pair))
        rows = rows.take(np.flatnonzero(~self.hit[motion, pair]))
        rows = self._open(rows)
        seen = relative(placed, rows.piece, rows.pair)
        rows = replace(rows, gap=box_gaps(scene, rows.pair, seen))
        left: list[_Pairs] = []
        number = self._still_open(rows)
        # Examine the nearest pair of each motion first: its distance often settles the other pairs.
        for turn in range(2):
            now = number if turn else self._promising(rows, number)
            part, normal = rows.take(now), np.empty((len(now), 3))
            chosen_now = seen.take(now)
            proposed = distances(scene, part.pair, chosen_now, normal=normal)
            exact = replace(part, gap=proved_gaps(scene, part.pair, chosen_now, normal, proposed))
            self._learn(exact, middle)
            left.append(self._along_planes(exact, normal, placed, (begin, end)))
            number = np.setdiff1d(number, now, assume_unique=True)
            number = number[self._still_open(rows.take(number))] if len(number) else number
        open_ = [self._open(part) for part in left]
        for part in open_:
            self._give_up(part, middle)
        open_ = [part.take(np.flatnonzero(~self.hit[part.motion, part.pair])) for part in open_]
        return (
            np.concatenate([part.piece for part in open_]) + base,
            np.concatenate([part.pair for part in open_]),
        )

    def _along_planes(self, rows: _Pairs, normal: Array, placed: Placed, ends: tuple[Array, Array]) -> _Pairs:
        """Return the rows, with a smaller `nearer` where planes with normals (R, 3) prove that the bodies
        stay farther apart.
        """
        number = self._still_open(rows)
        number = number[rows.gap[number] > self.scene.pairs.margin[rows.pair[number]]]
        if not len(number):
            return rows
        part, piece = rows.take(number), np.unique(rows.piece[number])
        begin, end = (times[piece] for times in ends)
        middle = placed.take(piece)
        speed, strength = self.course.peaks(begin, end)
        # Let A be the bound of the points' acceleration. In each half of a piece of d seconds, the gap of the
        # plane is at most A (d/2)^2 / 8 below the chord between its values at the middle and at the end.
        sharpest = accelerations(middle, speed, strength, speed * ((end - begin) / 2.0)[:, None])
        at = np.searchsorted(piece, part.piece)
        first, second = self.scene.pairs.first[part.pair], self.scene.pairs.second[part.pair]
        half = (end - begin)[at] / 2.0
        slack = sharpest[self.scene.boxes.joint[first], second, at] * half**2 / 8.0
        arms = place(self.scene, self.course.at(begin)), middle, place(self.scene, self.course.at(end))
        least = least_gap(self.scene, arms, at, part.pair, normal[number], slack)
        nearer = rows.nearer.copy()
        # `gap - least` is the most by which the distance can fall below the distance in the middle of the
        # piece.
        nearer[number] = np.minimum(part.nearer, part.gap - least)
        return replace(rows, nearer=nearer)

    def _give_up(self, rows: _Pairs, time: Array) -> None:
        """Report undecided pairs as too near if the two bodies move by less than `RESOLUTION` relative to
        each other.

        Such pairs may still get nearer than their margin.
        """
        margin = self.scene.pairs.margin[rows.pair]
        for row in np.flatnonzero((rows.apart <= RESOLUTION) & (rows.gap - rows.nearer < margin)):
            self._meet(rows, int(row), time)

    def _still_open(self, rows: _Pairs) -> Rows:
        """Return the rows whose pairs are still undecided; record the lower bounds of the other rows."""
        # The lower bound on the whole piece is the distance in its middle less the largest decrease from
        # there.
        surely = rows.gap - rows.nearer
        wanted = np.minimum(KNOWN, (1.0 - SHARE) * self.best[rows.motion, rows.kind] - COARSE)
        # A pair is settled if it keeps its margin, and if it is far enough not to change the least distance
        # by more than the allowed error.
        done = (surely >= self.scene.pairs.margin[rows.pair]) & (surely >= wanted)
        np.minimum.at(self.least, (rows.motion[done], rows.kind[done]), surely[done])
        return np.flatnonzero(~done)

    def _open(self, rows: _Pairs) -> _Pairs:
        return rows.take(self._still_open(rows))

    def _promising(self, rows: _Pairs, number: Rows) -> Rows:
        """Return, among the rows `number`, the one with the nearest pair for each motion and kind of pair."""
        order = number[np.argsort(rows.gap[number], kind="stable")]
        _, first = np.unique(3 * rows.motion[order] + rows.kind[order], return_index=True)
        return np.sort(order[first])

    def _learn(self, rows: _Pairs, time: Array) -> None:
        """Record the nearest distances, and the sample at which each pair is first found too near."""
        # Sort so that, of several rows of one motion, the nearest is written last.
        order = np.argsort(-rows.gap, kind="stable")
        at = rows.motion[order], rows.kind[order]
        nearer = rows.gap[order] < self.best[at]
        at = at[0][nearer], at[1][nearer]
        self.best[at], self.nearest[at] = rows.gap[order][nearer], rows.pair[order][nearer]
        for row in np.flatnonzero(rows.gap < self.scene.pairs.margin[rows.pair] + SLACK):
            self._meet(rows, int(row), time)

    def _meet(self, rows: _Pairs, row: int, time: Array) -> None:
        motion, pair = int(rows.motion[row]), int(rows.pair[row])
        if not self.hit[motion, pair]:
            self.hit[motion, pair] = True
            when = float(time[rows.piece[row]])
            self.meetings.append(Meeting(motion, pair, when, float(rows.gap[row])))
