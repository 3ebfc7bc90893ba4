"""A chain of motions without a stop between: how long each law is, how far they overlap, and the segment time of them all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from yarclang.hir import Array
from yarclang.motion.blend import Corner, Part, begins, both, shares, superpose, way_length
from yarclang.motion.cruise import cruise_law, fewest, fewest_at_speed
from yarclang.motion.curve import FEWEST_SEGMENTS, Curve, knot_values, middle_values
from yarclang.motion.limits import Bounds, Grid
from yarclang.motion.path import Path
from yarclang.motion.profile import Profile
from yarclang.motion.trials import Trial, Trials
from yarclang.robot.model import Chain, Tolerance

_LONGEST = 0.02
"""The longest segment of a chain [s], where the controller takes so short ones: an overlap is a whole number of them."""

_SHARES = (1.0, 0.9, 0.8, 0.65, 0.5)
"""Shares of the limits of acceleration and jerk that a law by itself may use. With a half, two always add up to no more than all."""

_WIDTHS = 14
"""How many widths of an overlap are tried, from the widest that has room on."""

_WITHIN = 0.98
"""The share of a ball that is used: between the places that are looked at the curve may go a little farther."""

_EXACT = 1e-7
"""Times that miss whole segments by less [s] don't miss them."""


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """One motion of a chain.

    `duration` [s] is None where the limits or a speed decide; `full` [s] is how long the way takes at a speed that is asked
    for. `corner` is where the next motion begins, None behind the last. `alone` is how the motion would go by itself.
    """

    path: Path
    profile: Profile
    duration: float | None
    full: float | None
    bounds: Bounds
    tolerance: Tolerance
    corner: Corner | None
    alone: Curve


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """What a chain makes of one motion: its curve from the middle of one overlap to that of the next, the segments of the
    overlap at its end (0: a stop), and the control values of its own law, from its rest to its rest.
    """

    curve: Curve
    overlap: int
    law: Array


def linked(chain: Chain, links: Sequence[Link], grid: Grid) -> list[Piece]:
    """Carry out a chain. Each motion can be done by itself, so the chain can, if need be with a stop at a corner.

    Laws that use all of a limit leave nothing for the one that they overlap with: several shares are tried.
    """
    found = [made for share in _SHARES if (made := _with_share(chain, links, grid, share)) is not None]
    alone = [Piece(link.alone, 0, link.alone.law) for link in links]
    return min(found, key=_preference, default=alone)


def _preference(pieces: list[Piece]) -> tuple[float, int]:
    """The shorter, and of equals the one with the wider overlaps."""
    duration = sum(piece.curve.duration for piece in pieces)
    return round(duration, 6), -sum(piece.overlap for piece in pieces)


def _with_share(chain: Chain, links: Sequence[Link], grid: Grid, share: float) -> list[Piece] | None:
    """The chain with laws that use a share of the limits of acceleration and jerk where they can."""
    segment = _segment(links, grid)
    while segment >= grid.smallest:
        made = _Maker(chain, links, grid, segment, share).made()
        if isinstance(made, list):
            return made
        segment = grid.nearest(made)
    return None


def _segment(links: Sequence[Link], grid: Grid) -> float:
    """A segment time of which all given durations are whole numbers, or nearly."""
    longest = max(
        grid.smallest, min(grid.largest, _LONGEST, *(link.profile.longest_segment for link in links))
    )
    given = np.array([link.duration for link in links if link.duration is not None])
    if not len(given):
        return grid.nearest(longest)
    shortest = float(given.min())
    least = max(FEWEST_SEGMENTS, math.ceil(shortest / longest - 1e-9))
    most = max(least, math.floor(shortest / grid.smallest))
    numbers = np.arange(least, most + 1)
    counts = given[None] * (numbers / shortest)[:, None]
    miss = (np.abs(counts - np.round(counts)) * (shortest / numbers)[:, None]).max(axis=1)
    exact = miss < _EXACT
    best = int(np.argmax(exact)) if exact.any() else int(np.argmin(miss))
    return grid.nearest(shortest / float(numbers[best]))


@dataclass(slots=True)
class _Maker:
    """The making of a chain with one segment time [s]."""

    chain: Chain
    links: Sequence[Link]
    grid: Grid
    segment: float
    share: float

    def made(self) -> list[Piece] | float:
        """The pieces; or a shorter segment time to try, where this one can't hold the paths."""
        trials = [self._trials(link, self.share) for link in self.links]
        middles = self._middles()
        if middles is None:
            return self.segment / 2.0
        overlaps = [0] * (len(self.links) - 1)
        for place, link in enumerate(self.links):
            if self._part(trials, middles, overlaps, place) is None:
                # its time asks for more than the share
                trials[place] = self._trials(link, 1.0)
                if self._part(trials, middles, overlaps, place) is None:
                    return self.segment / 2.0
        for corner in range(len(overlaps)):
            overlaps[corner] = self._widest(trials, middles, overlaps, corner)
        made = [self._part(trials, middles, overlaps, place) for place in range(len(self.links))]
        whole = [part for part in made if part is not None]
        assert len(whole) == len(self.links)
        for own, part in zip(trials, whole, strict=True):
            more = own.segments_for_tolerance(part.trial)
            if more is not None:
                return self.segment * part.segments / more
        return self._cut(whole, overlaps)

    def _trials(self, link: Link, share: float) -> Trials:
        bounds = link.bounds.reduced(1.0, share)
        if not link.profile.has_jerk_limit:
            bounds = bounds.without_jerk()
        law = (
            link.profile.law(link.path, bounds) if link.full is None else cruise_law(link.full / self.segment)
        )
        return Trials(link.path, law, bounds, link.tolerance)

    def _middles(self) -> list[int | None] | None:
        """How many segments each motion with a given duration has from middle to middle of its overlaps, None for the others; None
        for all where one would have too few.
        """
        middles: list[int | None] = []
        behind, counted = 0.0, 0
        for link in self.links:
            if link.duration is None:
                middles.append(None)
                continue
            # rounded over all, so that the whole chain is right where a seam can't be
            behind += link.duration
            number = round(behind / self.segment) - counted
            counted += number
            if number < FEWEST_SEGMENTS:
                return None
            middles.append(number)
        return middles

    def _part(
        self, trials: list[Trials], middles: list[int | None], overlaps: list[int], place: int
    ) -> Part | None:
        """A motion between its overlaps; None where it can't be done so."""
        own, link = trials[place], self.links[place]
        middle = middles[place]
        if middle is None:
            trial = self._fewest(own, link)
        else:
            beside = (overlaps[place - 1] if place else 0) + (overlaps[place] if place < len(overlaps) else 0)
            trial = own.within(middle + beside // 2, self.segment)
        if trial is None or trial.demand.segment > self.segment * (1.0 + 1e-12):
            return None
        return Part(link.path, trial)

    def _fewest(self, trials: Trials, link: Link) -> Trial | None:
        if link.full is not None:
            return fewest_at_speed(trials, link.full / self.segment, self.segment)

        def tried(number: int) -> Trial | None:
            trial = trials.fastest(number)
            return trial if trial.demand.segment <= self.segment else None

        least = max(FEWEST_SEGMENTS, math.floor(0.98 * link.alone.duration / self.segment))
        return fewest(tried, least, max(2 * least, least + 64))

    def _widest(
        self, trials: list[Trials], middles: list[int | None], overlaps: list[int], corner: int
    ) -> int:
        """The widest overlap at a corner that stays in its ball and within the limits; 0 if there is none."""
        first, second = (self._part(trials, middles, overlaps, place) for place in (corner, corner + 1))
        assert first is not None
        assert second is not None
        room = first.segments - (overlaps[corner - 1] if corner else 0)
        # of the second motion, half is left to the next corner
        half = second.segments if corner + 1 == len(overlaps) else second.segments // 2
        widest = min(room, half) // 2
        if widest < 1:
            return 0

        def serves(pairs: int) -> bool:
            trying = list(overlaps)
            trying[corner] = 2 * pairs
            return self._serves(trials, middles, trying, corner)

        # sums of two laws don't grow evenly with their overlap: look at all sizes, then closer at the best
        widths = np.unique(np.round(np.geomspace(1, widest, _WIDTHS)).astype(int))[::-1].tolist()
        place = next((place for place, pairs in enumerate(widths) if serves(pairs)), None)
        if place is None:
            return 0
        low, high = widths[place], widths[place - 1] if place else widths[0]
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if serves(middle) else (low, middle)
        return 2 * int(low)

    def _serves(
        self, trials: list[Trials], middles: list[int | None], overlaps: list[int], place: int
    ) -> bool:
        first, second = (self._part(trials, middles, overlaps, number) for number in (place, place + 1))
        corner, overlap = self.links[place].corner, overlaps[place]
        if first is None or second is None or corner is None:
            return False
        before = overlaps[place - 1] if place else 0
        if overlap > min(first.segments - before, second.segments):
            return False
        if not corner.is_tangent and not self._in_ball(first, second, corner, overlap):
            return False
        points = superpose(self.chain, (first, second), (corner,), (overlap,))
        begin = first.segments - overlap
        around = points[max(begin - 2, 0) : begin + overlap + 5]
        loosest = self._loosest(place)
        if max(demand.segment for demand in loosest.demands(around)) > self.segment:
            return False
        return not corner.is_tangent or self._on_both(first, second, points, overlap)

    def _in_ball(self, first: Part, second: Part, corner: Corner, overlap: int) -> bool:
        """Whether an overlap stays in the ball round its corner."""
        done, begun = shares(first, second, overlap)
        ends = knot_values(first.trial.control)[[-1 - overlap]], knot_values(second.trial.control)[[overlap]]
        outer = np.concatenate((first.path.joints(ends[0]), second.path.joints(ends[1])))
        if corner.farthest(self.chain, outer).max() > _WITHIN:
            return False
        inner = both(self.chain, first.path, second.path, corner, done, begun)
        return bool(corner.farthest(self.chain, inner).max(initial=0.0) <= _WITHIN)

    def _on_both(self, first: Part, second: Part, points: Array, overlap: int) -> bool:
        """Whether the curve is on one of two tangent paths in the middle of each segment of their overlap."""
        begin = first.segments - overlap
        q = middle_values(points[begin : begin + overlap + 3])
        done = middle_values(first.trial.control)[-overlap:]
        begun = middle_values(second.trial.control)[:overlap]
        lengths = way_length(first.path), way_length(second.path)
        gone = done * lengths[0] + begun * lengths[1]
        tolerance = self.links[0].tolerance
        for path, here, s in (
            (first.path, gone <= lengths[0], gone / lengths[0]),
            (second.path, gone > lengths[0], (gone - lengths[0]) / lengths[1]),
        ):
            if here.any():
                position, angle = path.deviation(q[here], np.clip(s[here], 0.0, 1.0))
                if position > 0.7 * tolerance.position or angle > 0.7 * tolerance.angle:
                    return False
        return True

    def _loosest(self, place: int) -> Bounds:
        """What two motions together may use where they overlap: of each limit the larger share."""
        one, other = (
            link.bounds if link.profile.has_jerk_limit else link.bounds.without_jerk()
            for link in self.links[place : place + 2]
        )
        return replace(
            one,
            velocity=np.maximum(one.velocity, other.velocity),
            acceleration=np.maximum(one.acceleration, other.acceleration),
            jerk=np.maximum(one.jerk, other.jerk),
            motor_velocity=np.maximum(one.motor_velocity, other.motor_velocity),
        )

    def _cut(self, parts: list[Part], overlaps: list[int]) -> list[Piece]:
        """The chain's curve, cut in the middle of its overlaps."""
        corners = [link.corner for link in self.links if link.corner is not None]
        points = superpose(self.chain, parts, corners, overlaps)
        points.setflags(write=False)
        starts = begins(parts, overlaps)
        pieces = []
        for place, (part, begin) in enumerate(zip(parts, starts, strict=True)):
            before = overlaps[place - 1] // 2 if place else 0
            behind = overlaps[place] // 2 if place < len(overlaps) else 0
            first, last = begin + before, begin + part.segments - behind
            law = part.trial.control[before : part.segments - behind + 3]
            curve = Curve(points[first : last + 3], self.segment, law)
            pieces.append(Piece(curve, 2 * behind, part.trial.control))
        return pieces
