"""Chains whose laws are those that the motions would have by themselves, with something of the limits in reserve.

Laws that use all of a limit leave nothing for the one that they overlap with.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.blend import Part
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.chains.overlaps import SPEED_KEPT, Overlaps, widest
from yarclang.motion.cruise import cruise_law, fewest, fewest_at_speed
from yarclang.motion.curve import FEWEST_SEGMENTS
from yarclang.motion.framespeed import finer_for_speed
from yarclang.motion.profile import NoLaw
from yarclang.motion.trials import Trial, Trials
from yarclang.robot.model import Chain


def apart(
    chain: Chain, links: Sequence[Link], segment: float, middles: Sequence[int | None], share: float
) -> list[Piece] | float | None:
    """The pieces of a chain whose laws use a share of the limits of acceleration and jerk where they can.

    Args:
        chain: the arm.
        links: the motions.
        segment: the segment time [s].
        middles: the segments of each motion whose duration is given, from middle to middle of its overlaps.
        share: of the limits of acceleration and jerk.

    Returns:
        The pieces; or a shorter segment time to try; or None if a motion has no law for this share.
    """
    return _Maker(links, Overlaps(chain, links, segment), segment, middles, share).made()


@dataclass(slots=True)
class _Maker:
    links: Sequence[Link]
    corners: Overlaps
    segment: float
    middles: Sequence[int | None]
    share: float
    _free: dict[tuple[int, int], Trial | None] = field(default_factory=dict)
    """The trials of motions whose time isn't given, by their place and the trials that they are of: they are the same whatever the overlaps."""

    def made(self) -> list[Piece] | float | None:
        trials = [own for link in self.links if (own := self._trials(link, self.share)) is not None]
        if len(trials) < len(self.links):
            return None
        overlaps = [0] * (len(self.links) - 1)
        for place, link in enumerate(self.links):
            if self._part(trials, overlaps, place) is None:
                # its time asks for more than the share
                whole = self._trials(link, 1.0)
                if whole is None:
                    return None
                trials[place] = whole
                if self._part(trials, overlaps, place) is None:
                    return self.segment / 2.0
        for place in range(len(overlaps)):
            overlaps[place] = self._widest(trials, overlaps, place)
        parts = [part for place in range(len(self.links)) if (part := self._part(trials, overlaps, place))]
        for own, part in zip(trials, parts, strict=True):
            more = own.segments_for_tolerance(part.trial)
            if more is not None:
                return self.segment * part.segments / more
        for link, part in zip(self.links, parts, strict=True):
            if link.full is not None and isinstance(link.path, CartesianPath):
                finer = finer_for_speed(link.path, part.trial, self.segment)
                if finer is not None:
                    return finer
        return self.corners.cut(parts, overlaps)

    def _trials(self, link: Link, share: float) -> Trials | None:
        """The trials of a motion with a share of the limits; None if it has no law for them."""
        bounds = link.own_bounds.reduced(1.0, share)
        law = (
            link.profile.law(link.path, bounds) if link.full is None else cruise_law(link.full / self.segment)
        )
        if isinstance(law, NoLaw):
            return None
        return Trials(link.path, law, bounds, link.tolerance)

    def _part(self, trials: list[Trials], overlaps: list[int], place: int) -> Part | None:
        """A motion between its overlaps; None where it can't be done so."""
        own, link = trials[place], self.links[place]
        middle = self.middles[place]
        trial: Trial | None
        if middle is None:
            key = place, id(own)
            if key not in self._free:
                self._free[key] = self._fewest(own, link)
            trial = self._free[key]
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

    def _widest(self, trials: list[Trials], overlaps: list[int], place: int) -> int:
        """The widest overlap at a corner; 0 if there is none."""
        first, second = (self._part(trials, overlaps, number) for number in (place, place + 1))
        assert first is not None
        assert second is not None
        before = overlaps[place - 1] if place else 0
        # of the second motion, half is left to the next corner
        half = second.segments if place + 1 == len(overlaps) else second.segments // 2

        def serves(overlap: int) -> bool:
            trying = list(overlaps)
            trying[place] = overlap
            one, other = (self._part(trials, trying, number) for number in (place, place + 1))
            if one is None or other is None or overlap > one.segments - before:
                return False
            return (
                self.corners.serves(one, other, place, overlap)
                and self.corners.excess(one, other, place, overlap) <= 1.0 + SPEED_KEPT
            )

        return widest(serves, min(first.segments - before, half))
