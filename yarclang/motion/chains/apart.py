"""Plan chains of motions in two steps: plan the motion profile of each motion by itself, then let
neighbouring profiles overlap.

Where two profiles overlap, their accelerations add up. Therefore each profile uses only a share of the limits
of acceleration and jerk.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.blend import Part
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.chains.overlaps import SPEED_KEPT, Inside, Overlaps, widest
from yarclang.motion.cruise import cruise_law, fewest, fewest_at_speed
from yarclang.motion.curve import FEWEST_SEGMENTS, knot_values
from yarclang.motion.framespeed import finer_for_speed
from yarclang.motion.profile import NoLaw
from yarclang.motion.trials import Trial, Trials
from yarclang.robot.model import Chain

_MORE, _LITTLE = 0.03, 0.002
"""Margins that are added to the share of a path that is inside a corner's ball: `_MORE` is relative to this
share, `_LITTLE` is a share of the whole path.
"""


def apart(
    chain: Chain,
    links: Sequence[Link],
    share: float,
    inside: Sequence[Inside],
    at_most: tuple[float, float],
    segment: float,
    middles: Sequence[int | None],
) -> list[Piece] | float | None:
    """Plan a chain in which each motion's profile uses only a share of the limits of acceleration and jerk,
    where possible.

    Args:
        chain: the arm.
        links: the motions of the chain.
        share: share of the limits of acceleration and jerk that one profile may use.
        inside: for each corner, as returned by `find_inside`.
        at_most: two durations [s]. A plan without a stop at a corner is of no use above the first one,
            and a plan with stops above the second one.
        segment: the segment time [s].
        middles: for each motion with a given duration, its number of segments from the middle of one
            overlap to the middle of the next.

    Returns:
        The planned motions, or a shorter segment time to try. None if a motion has no profile within this
        share, or the plan is of no use.
    """
    return _Maker(links, Overlaps(chain, links, segment), segment, middles, share, inside, *at_most).made()


@dataclass(slots=True)
class _Maker:
    links: Sequence[Link]
    corners: Overlaps
    segment: float
    middles: Sequence[int | None]
    share: float
    inside: Sequence[Inside]
    at_most: float
    at_most_with_stops: float
    _free: dict[tuple[int, int], Trial | None] = field(default_factory=dict)
    """Cache of planned motions that have no given duration and therefore don't depend on the overlaps. The
    key is the index of the motion and the identity of its `Trials`.
    """

    def made(self) -> list[Piece] | float | None:
        trials = [
            candidates for link in self.links if (candidates := self._trials(link, self.share)) is not None
        ]
        if len(trials) < len(self.links):
            return None
        overlaps = [0] * (len(self.links) - 1)
        for place, link in enumerate(self.links):
            if self._part(trials, overlaps, place) is None:
                # In its given duration, this motion can't keep the share of the limits: let it use the whole
                # limits.
                whole = self._trials(link, 1.0)
                if whole is None:
                    return None
                trials[place] = whole
                if self._part(trials, overlaps, place) is None:
                    return self.segment / 2.0
        least, rooms = self._least(trials, overlaps)
        for place in range(len(overlaps)):
            if least > (self.at_most if all(overlaps[:place]) else self.at_most_with_stops):
                return None
            # Choose the overlaps from the first corner to the last. `least` was computed with the greatest
            # overlap at each corner: correct it for the chosen one.
            overlaps[place] = self._widest(trials, overlaps, place, rooms[place])
            least += self._saved(place, rooms[place]) - self._saved(place, overlaps[place])
        parts = [part for place in range(len(self.links)) if (part := self._part(trials, overlaps, place))]
        for candidates, part in zip(trials, parts, strict=True):
            more = candidates.segments_for_tolerance(part.trial)
            if more is not None:
                return self.segment * part.segments / more
        for link, part in zip(self.links, parts, strict=True):
            if link.full is not None and isinstance(link.path, CartesianPath):
                finer = finer_for_speed(link.path, part.trial, self.segment)
                if finer is not None:
                    return finer
        return self.corners.cut(parts, overlaps)

    def _least(self, trials: list[Trials], overlaps: list[int]) -> tuple[float, list[int]]:
        """Return a lower bound of the chain's duration [s], and an upper bound of the overlap at each corner
        [segments].

        Up to this overlap, the overlapping parts of both motions can be inside the corner's ball.
        """
        parts = [self._part(trials, overlaps, place) for place in range(len(self.links))]
        segments = [
            part.segments if middle is None and part is not None else middle or 0
            for part, middle in zip(parts, self.middles, strict=True)
        ]
        rooms = []
        for place, shares in enumerate(self.inside):
            corner, room = self.links[place].corner, sum(segments)
            for side in (place, place + 1):
                # The profile of a motion with a given duration depends on its overlaps. Such a motion gives
                # no bound of the overlap.
                if self.middles[side] is not None:
                    continue
                room = min(room, segments[side])
                if corner is not None and not corner.is_tangent:
                    within = _segments_within(parts[side], shares[side - place], is_end=side == place)
                    room = min(room, within)
            rooms.append(room)
        saved = sum(self._saved(place, room) for place, room in enumerate(rooms))
        return sum(segments) * self.segment - saved, rooms

    def _saved(self, place: int, overlap: int) -> float:
        """Return the time by which an overlap of two motions shortens the chain [s].

        Each of the two motions saves half of the overlap, unless its duration is given.
        """
        return overlap * self.segment * sum(self.middles[side] is None for side in (place, place + 1)) / 2.0

    def _trials(self, link: Link, share: float) -> Trials | None:
        """Return the candidates for a motion that uses a share of the limits; None if no motion profile keeps
        within this share.
        """
        bounds = link.own_bounds.reduced(1.0, share)
        law = (
            link.profile.law(link.path, bounds) if link.full is None else cruise_law(link.full / self.segment)
        )
        if isinstance(law, NoLaw):
            return None
        return Trials(link.path, law, bounds, link.tolerance)

    def _part(self, trials: list[Trials], overlaps: list[int], place: int) -> Part | None:
        """Return a motion planned for its present overlaps; None if it can't keep the limits."""
        candidates, link = trials[place], self.links[place]
        middle = self.middles[place]
        trial: Trial | None
        if middle is None:
            key = place, id(candidates)
            if key not in self._free:
                self._free[key] = self._fewest(candidates, link)
            trial = self._free[key]
        else:
            # A given duration counts from the middle of one overlap to the middle of the next: add half of
            # each overlap.
            beside = (overlaps[place - 1] if place else 0) + (overlaps[place] if place < len(overlaps) else 0)
            trial = candidates.within(middle + beside // 2, self.segment)
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

    def _widest(self, trials: list[Trials], overlaps: list[int], place: int, room: int) -> int:
        """Return the widest overlap that a corner allows, at most `room` segments; 0 if there is none."""
        first, second = (self._part(trials, overlaps, number) for number in (place, place + 1))
        assert first is not None
        assert second is not None
        before = overlaps[place - 1] if place else 0
        # Half of the second motion is reserved for the next corner.
        half = second.segments if place + 1 == len(overlaps) else second.segments // 2

        def serves(overlap: int) -> bool:
            if overlap > room:
                return False
            trying = list(overlaps)
            trying[place] = overlap
            one, other = (self._part(trials, trying, number) for number in (place, place + 1))
            if one is None or other is None or overlap > one.segments - before:
                return False
            if not self._is_kept(one, other, place, overlap):
                return False
            if not before or self.middles[place] is None:
                return True
            # The profile of a motion with a given duration depends on both of its overlaps: check the corner
            # before the motion again.
            earlier = self._part(trials, trying, place - 1)
            return earlier is not None and self._is_kept(earlier, one, place - 1, before)

        return widest(serves, min(first.segments - before, half))

    def _is_kept(self, one: Part, other: Part, place: int, overlap: int) -> bool:
        """Return True if two motions may overlap by `overlap` segments.

        While they overlap, the joints must be within their limits, the frame must stay within the distance
        of the corner that BLEND allows, and it must be no faster than requested.
        """
        return (
            self.corners.serves(one, other, place, overlap)
            and self.corners.excess(one, other, place, overlap) <= 1.0 + SPEED_KEPT
        )


def _segments_within(part: Part | None, share: float, *, is_end: bool) -> int:
    """Return an upper bound of the number of segments in which a motion covers a given share of its path: the
    last share if `is_end`, otherwise the first one.
    """
    assert part is not None
    if share >= 0.5:
        return part.segments
    gone = knot_values(part.trial.control)
    room = (1.0 + _MORE) * share + _LITTLE
    if is_end:
        return part.segments - int(np.searchsorted(gone, 1.0 - room)) + 1
    return int(np.searchsorted(gone, room)) + 1
