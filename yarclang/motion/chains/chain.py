"""A chain of motions without a stop between: how long each law is, how far they overlap, and the segment time of them all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from yarclang.motion.chains.apart import apart
from yarclang.motion.chains.corners import MANY
from yarclang.motion.chains.flowing.flow import flowing
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.chains.overlaps import Inside, find_inside
from yarclang.motion.chains.steady import Beaten, steady
from yarclang.motion.curve import FEWEST_SEGMENTS
from yarclang.motion.limits import Grid
from yarclang.robot.model import Chain

_LONGEST = 0.02
"""The longest segment of a chain [s], where the controller takes so short ones: an overlap is a whole number of them."""

_SHORTEST = 0.004
"""Segments aren't made shorter than this [s] for the sake of a steady speed."""

_SHARES = (1.0, 0.9, 0.8, 0.65, 0.5)
"""Shares of the limits of acceleration and jerk that a law by itself may use. With a half, two always add up to no more than all."""

_FOR_FLOW = 1.1
"""A chain may take so many times as long as the fastest one for the sake of fewer stops: a blend is asked for to flow."""

_ABOUT = 1.005
"""What is slower by no more than this is as good: then longer segments, which come first, are."""

_EXACT = 1e-7
"""Times that miss whole segments by less [s] don't miss them."""

Way = Callable[[float, list[int | None]], list[Piece] | float | Beaten | None]
"""A way to carry out a chain: with a segment time [s] and the segments of given durations, the pieces, a segment time to try, how long it takes at least if that
is too long, or None."""


def linked(chain: Chain, links: Sequence[Link], grid: Grid) -> list[Piece]:
    """Carry out a chain in the way that has the fewest stops and isn't much slower than the fastest.

    Each motion can be done by itself, so the chain can, if need be with a stop at a corner. What a way takes at least is known long before it is made: one that
    takes longer than a chain that is made already is given up.
    """
    as_one = flowing(links, grid)
    if as_one is not None and len(links) > MANY:
        return as_one
    inside = find_inside(chain, links)
    steady_ones = None if len(links) > MANY else _Steady(chain, links, grid, inside)
    if steady_ones and all(link.duration is not None or link.full is not None for link in links):
        asked = steady_ones.made(0.0)
        if asked and _is_as_asked(links, asked[-1]):
            return asked[-1]
    flows = [] if as_one is None else [as_one]
    apart_ones = list[list[Piece]]()
    for share in _SHARES:
        quickest = _quickest(flows + apart_ones)
        way = partial(apart, chain, links, share, inside, (quickest, quickest / _FOR_FLOW))
        made = _made(way, links, grid)
        if isinstance(made, list):
            apart_ones.append(made)
    found = flows + apart_ones
    if steady_ones:
        found = steady_ones.made(_ABOUT * _quickest(found)) + found
    if not found:
        return [link.as_alone for link in links]
    fastest = min(_duration(pieces) for pieces in found)
    quick = [pieces for pieces in found if _duration(pieces) <= _FOR_FLOW * fastest]
    fewest = min(_stops(pieces) for pieces in quick)
    quick = [pieces for pieces in quick if _stops(pieces) == fewest]
    enough = _ABOUT * min(_duration(pieces) for pieces in quick)
    return next(pieces for pieces in quick if _duration(pieces) <= enough)


def _quickest(found: Sequence[list[Piece]]) -> float:
    """Return the shortest duration [s] of what has no stop but the last."""
    return min((_duration(pieces) for pieces in found if _stops(pieces) == 1), default=math.inf)


def _is_as_asked(links: Sequence[Link], pieces: Sequence[Piece]) -> bool:
    """Whether all motions have a time or a speed of their own, and are done just so: nothing better can be found."""
    return all(
        link.duration is not None or (link.full is not None and piece.kept > 1.0 - 1e-9)
        for link, piece in zip(links, pieces, strict=True)
    )


@dataclass(slots=True)
class _Steady:
    """The chain at steady speed. `_least` are the times [s] that it takes at least where its segments aren't longer than a time [s], as far as they are known."""

    chain: Chain
    links: Sequence[Link]
    grid: Grid
    inside: Sequence[Inside]
    _least: dict[float, float] = field(default_factory=dict)

    def made(self, at_most: float) -> list[list[Piece]]:
        """Return what the limits allow, and what isn't as asked only if it doesn't take longer than a time [s]: with shorter segments there is more room for turns."""
        found: list[list[Piece]] = []
        grid, longest = self.grid, _LONGEST
        while longest >= max(grid.smallest, _SHORTEST) and len(found) < 3:
            shorter = replace(grid, largest=max(grid.smallest, min(grid.largest, longest)))
            made = None
            if self._least.get(longest, 0.0) <= at_most:
                way = partial(steady, self.chain, self.links, self.inside, at_most)
                made = _made(way, self.links, shorter)
            if isinstance(made, Beaten):
                self._least[longest] = made.least
            if isinstance(made, list):
                found.append(made)
                if _is_as_asked(self.links, made):
                    break
            longest /= 2.0
        return found


def _stops(pieces: list[Piece]) -> int:
    return sum(piece.overlap is None for piece in pieces)


def _duration(pieces: list[Piece]) -> float:
    return sum(piece.curve.duration for piece in pieces)


def _made(way: Way, links: Sequence[Link], grid: Grid) -> list[Piece] | Beaten | None:
    """What a way makes of a chain, with the segments as long as they may be."""
    segment = _segment(links, grid)
    while segment >= grid.smallest:
        middles = _middles(links, segment)
        made = way(segment, middles) if middles is not None else segment / 2.0
        if not isinstance(made, float):
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


def _middles(links: Sequence[Link], segment: float) -> list[int | None] | None:
    """How many segments each motion with a given duration has from middle to middle of its overlaps, None for the others; None
    for all where one would have too few.
    """
    middles: list[int | None] = []
    behind, counted = 0.0, 0
    for link in links:
        if link.duration is None:
            middles.append(None)
            continue
        # rounded over all, so that the whole chain is right where a seam can't be
        behind += link.duration
        number = round(behind / segment) - counted
        counted += number
        if number < FEWEST_SEGMENTS:
            return None
        middles.append(number)
    return middles
