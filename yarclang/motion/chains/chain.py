"""Plan a chain of motions without a stop: choose the motion profiles, their overlaps, and the common segment
time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise

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
"""Longest segment of a chain [s]. It is short since the length of an overlap is an integer number of
segments.

If the controller's shortest segment is longer than this, chains have that segment time instead.
"""

_SHORTEST = 0.004
"""Shortest segment time that is tried for chains that keep their speed through corners [s]."""

_SHARES = (1.0, 0.9, 0.8, 0.65, 0.5)
"""Shares of the limits of acceleration and jerk that a single motion profile may use. With a share of a half,
two overlapping profiles never add up to more than the limits.
"""

_FOR_FLOW = 1.1
"""Factor by which a chain with fewer stops may take longer than the fastest chain. It is more than 1, since
users request a blend in order to avoid a stop, not only to save time.
"""

_ABOUT = 1.005
"""Factor up to which a slower plan of a chain counts as equally fast. Of equally fast plans the first one is
taken, since earlier plans have longer segments.
"""

_EXACT = 1e-7
"""Difference from an integer number of segments up to which a duration counts as exact [s]."""

Way = Callable[[float, list[int | None]], list[Piece] | float | Beaten | None]
"""A method of planning a chain. It is called with a segment time [s] and, for each motion, with its number of
segments if its duration is given (None otherwise).

It returns the planned motions, or a segment time to try next. It returns None if it has no plan, and `Beaten`
with a lower bound of the chain's duration if another plan is certainly faster.
"""


def linked(chain: Chain, links: Sequence[Link], grid: Grid) -> list[Piece]:
    """Plan a chain of motions with the fewest stops at corners, unless such a plan is much slower than the
    fastest one.

    Each motion can be executed by itself, so the chain always has a plan, if necessary with stops at corners.
    A method of planning knows a lower bound of the chain's duration long before its plan is complete. The
    method is given up once this bound exceeds the duration of a finished plan.
    """
    as_one = flowing(links, grid)
    if as_one is not None and len(links) > MANY:
        return as_one
    inside = find_inside(chain, links)
    steady_ones = None if len(links) > MANY else _Steady(chain, links, grid, inside)
    # If all motions have a given duration or speed, no plan is better than a chain that keeps these durations
    # and speeds through its corners: try it first.
    if steady_ones and all(link.duration is not None or link.full is not None for link in links):
        asked = steady_ones.made(0.0)
        if asked and _is_as_asked(links, asked[-1]):
            return asked[-1]
    flows = [] if as_one is None else [as_one]
    apart_ones = list[list[Piece]]()
    # Try profiles that are planned separately. With a smaller share of the limits, each profile is slower,
    # but the profiles may overlap more.
    for share in _SHARES:
        quickest = _quickest(flows + apart_ones)
        way = partial(apart, chain, links, share, inside, (quickest, quickest / _FOR_FLOW))
        made = _made(way, links, grid)
        if isinstance(made, list):
            apart_ones.append(made)
    plans = flows + apart_ones
    if steady_ones:
        plans = steady_ones.made(_ABOUT * _quickest(plans)) + plans
    if not plans:
        return _parted(chain, links, grid)
    # Of the plans that are not much slower than the fastest, take those with the fewest stops, and of these
    # the fastest.
    fastest = min(_duration(pieces) for pieces in plans)
    quick = [pieces for pieces in plans if _duration(pieces) <= _FOR_FLOW * fastest]
    fewest = min(_stops(pieces) for pieces in quick)
    quick = [pieces for pieces in quick if _stops(pieces) == fewest]
    enough = _ABOUT * min(_duration(pieces) for pieces in quick)
    return next(pieces for pieces in quick if _duration(pieces) <= enough)


def _parted(chain: Chain, links: Sequence[Link], grid: Grid) -> list[Piece]:
    """Plan a chain that can't be planned as a whole, as several chains with stops between them.

    The robot stops at corners where even two motions alone can't flow into each other. If there is no such
    corner, it stops in the middle of the chain.
    """
    count = len(links)
    if count == 2 or count > MANY:
        return [link.as_alone for link in links]
    ends = [
        place
        for place in range(1, count)
        if linked(chain, _alone(links, place - 1, place + 1), grid)[0].overlap is None
    ]
    edges = [0, *(ends or [count // 2]), count]
    pieces = list[Piece]()
    for begin, end in pairwise(edges):
        part = _alone(links, begin, end)
        pieces += linked(chain, part, grid) if len(part) > 1 else [part[0].as_alone]
    return pieces


def _alone(links: Sequence[Link], begin: int, end: int) -> list[Link]:
    """Return a part of a chain as a chain that ends with a stop."""
    *flow, last = links[begin:end]
    return [*flow, replace(last, corner=None)]


def _quickest(found: Sequence[list[Piece]]) -> float:
    """Return the shortest duration [s] among plans that stop only at the end of the chain."""
    return min((_duration(pieces) for pieces in found if _stops(pieces) == 1), default=math.inf)


def _is_as_asked(links: Sequence[Link], pieces: Sequence[Piece]) -> bool:
    """Return True if each motion has a given duration, or reaches its requested speed. Then no other plan can
    be better.
    """
    return all(
        link.duration is not None or (link.full is not None and piece.kept > 1.0 - 1e-9)
        for link, piece in zip(links, pieces, strict=True)
    )


@dataclass(slots=True)
class _Steady:
    """Planner of a chain that keeps its speed through corners.

    `_least` maps a largest segment time [s] to a lower bound of the chain's duration [s] with such segments.
    """

    chain: Chain
    links: Sequence[Link]
    grid: Grid
    inside: Sequence[Inside]
    _least: dict[float, float] = field(default_factory=dict)

    def made(self, at_most: float) -> list[list[Piece]]:
        """Return plans of the chain within the limits.

        A plan in which a motion misses its requested speed is included only if it takes no longer than
        `at_most` [s]. Shorter segments are tried as well, since they give more room for the ramps at corners.
        """
        plans: list[list[Piece]] = []
        grid, longest = self.grid, _LONGEST
        while longest >= max(grid.smallest, _SHORTEST) and len(plans) < 3:
            shorter = replace(grid, largest=max(grid.smallest, min(grid.largest, longest)))
            plan = None
            if self._least.get(longest, 0.0) <= at_most:
                way = partial(steady, self.chain, self.links, self.inside, at_most)
                plan = _made(way, self.links, shorter)
            if isinstance(plan, Beaten):
                self._least[longest] = plan.least
            if isinstance(plan, list):
                plans.append(plan)
                if _is_as_asked(self.links, plan):
                    break
            longest /= 2.0
        return plans


def _stops(pieces: list[Piece]) -> int:
    return sum(piece.overlap is None for piece in pieces)


def _duration(pieces: list[Piece]) -> float:
    return sum(piece.curve.duration for piece in pieces)


def _made(way: Way, links: Sequence[Link], grid: Grid) -> list[Piece] | Beaten | None:
    """Plan a chain by one method, with the longest segment time that works."""
    segment = _segment(links, grid)
    while segment >= grid.smallest:
        middles = _middles(links, segment)
        made = way(segment, middles) if middles is not None else segment / 2.0
        if not isinstance(made, float):
            return made
        segment = grid.nearest(made)
    return None


def _segment(links: Sequence[Link], grid: Grid) -> float:
    """Return a segment time [s] such that all given durations are integer multiples of it, at least
    approximately.
    """
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
    # Divide the shortest given duration into 1, 2, 3, ... segments, and measure by how much the other
    # durations differ from an integer number of these segments.
    counts = given[None] * (numbers / shortest)[:, None]
    miss = (np.abs(counts - np.round(counts)) * (shortest / numbers)[:, None]).max(axis=1)
    exact = miss < _EXACT
    best = int(np.argmax(exact)) if exact.any() else int(np.argmin(miss))
    return grid.nearest(shortest / float(numbers[best]))


def _middles(links: Sequence[Link], segment: float) -> list[int | None] | None:
    """Return, for each motion with a given duration, its number of segments from the middle of one overlap to
    the middle of the next.

    The entry of any other motion is None. The whole result is None if a motion would have too few segments.
    """
    middles: list[int | None] = []
    elapsed, counted = 0.0, 0
    for link in links:
        if link.duration is None:
            middles.append(None)
            continue
        # Round the elapsed time, not each duration, so that the duration of the whole chain is exact even if
        # those of its motions can't be.
        elapsed += link.duration
        number = round(elapsed / segment) - counted
        counted += number
        if number < FEWEST_SEGMENTS:
            return None
        middles.append(number)
    return middles
