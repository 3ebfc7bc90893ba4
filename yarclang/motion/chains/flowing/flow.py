"""Plan a chain as one path: try several smoothings, cut the chain into windows, and plan each window by
itself.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.memory import Memory
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.flowing.demands import Demands, Limits, Smoothing
from yarclang.motion.chains.flowing.law import Law
from yarclang.motion.chains.flowing.seams import merged, windows
from yarclang.motion.chains.flowing.way import Way
from yarclang.motion.chains.flowing.window import Failed, Made, Window, made
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.curve import Curve
from yarclang.motion.limits import Grid
from yarclang.parallel import mapped

_SEGMENTS = (0.02, 0.01, 0.005, 0.0025)
"""Segment times that are tried [s]."""
_WIDTHS = ((4, 1), (6, 3), (3, 2), (8, 4), (2, 1))
"""Durations of the first and of the second moving average that are tried [segments]."""
_ENOUGH = 1.02
"""Factor up to which a slower motion profile counts as equally fast. Among equally fast ones, those with
longer segments are tried first, then those with shorter moving averages.
"""
_TOO_SLOW = 2e-4
"""Speed at a corner below which the motion stops there instead [m/s]."""


@frozen(eq=False)
class Known:
    """Results of windows of chains from earlier plans.

    `keys` has a key for each motion, which contains everything that the motion requests.
    """

    memory: Memory
    keys: Sequence[Hashable]

    def get(self, way: Way, window: Window, smoothing: Smoothing) -> Made | Failed | None:
        """Return the result of a window from an earlier plan, or None."""
        found: Made | Failed | None = self.memory.get(self._key(way, window, smoothing))
        return found

    def keep(self, way: Way, window: Window, smoothing: Smoothing, result: Made | Failed) -> None:
        """Store the result of a window for later plans."""
        self.memory.keep(self._key(way, window, smoothing), result)

    def _key(self, way: Way, window: Window, smoothing: Smoothing) -> Hashable:
        first, last = window.around(way, smoothing)
        own = (window.first - first, window.last - first, window.speeds)
        return ("window", smoothing.segment, smoothing.widths, own, *self.keys[first:last])


def flowing(links: Sequence[Link], grid: Grid, known: Known | None = None) -> list[Piece] | None:
    """Plan a chain of motions of one moving frame as one path; None if that isn't possible.

    Args:
        links: the motions of the chain.
        grid: the segment times that the controller accepts.
        known: earlier results of windows of such chains, or None.

    Returns:
        The planned motions, each as a part of the chain's curve.
    """
    if not is_one_path(links):
        return None
    way = Way.of([link.path for link in links if isinstance(link.path, CartesianPath)])
    limits = Limits.of(links, way)
    demands = Demands.of(way, limits)
    stops = np.flatnonzero(_fastest_corners(demands, grid) < _TOO_SLOW)
    if len(stops):
        edges = [0, *(stops + 1).tolist(), len(links)]
        parts = [
            _flowing(links[a:b], grid, known and replace(known, keys=known.keys[a:b]))
            for a, b in pairwise(edges)
        ]
        return None if any(part is None for part in parts) else [one for part in parts for one in part or ()]
    return _of_demands(demands, way, grid, known)


def _flowing(links: Sequence[Link], grid: Grid, known: Known | None) -> list[Piece] | None:
    """Plan motions that follow each other without a stop; None if they can't be planned as one path."""
    way = Way.of([link.path for link in links if isinstance(link.path, CartesianPath)])
    return _of_demands(Demands.of(way, Limits.of(links, way)), way, grid, known)


def _fastest_corners(demands: Demands, grid: Grid) -> Array:
    """Return the largest speeds (k - 1,) [m/s] at which the corners can be passed with the shortest
    segments.
    """
    shortest = min(_segments(grid))
    ceilings = [demands.ceilings(Smoothing(shortest, widths))[0][demands.corners] for widths in _WIDTHS]
    fastest: Array = np.max(ceilings, axis=0)
    return fastest


def _segments(grid: Grid) -> list[float]:
    """Return the segment times to try [s]."""
    times = [grid.nearest(time) for time in _SEGMENTS]
    return [time for time in times if grid.smallest <= time <= grid.largest] or [grid.smallest]


def _of_demands(demands: Demands, way: Way, grid: Grid, known: Known | None) -> list[Piece] | None:
    for smoothing in _likeliest(demands, grid):
        parts = _made(way, demands, smoothing, known)
        if parts is not None:
            return _pieces(parts, smoothing.segment)
    return None


def _made(way: Way, demands: Demands, smoothing: Smoothing, known: Known | None) -> list[Made] | None:
    """Return the results of all windows of a chain; None if a window without seams fails.

    If a window with a seam fails, it is merged with its neighbours and planned again.
    """
    cut, found, reach = windows(way, demands, smoothing), dict[Window, Made | Failed](), 1
    while True:
        _make(way, demands, smoothing, [window for window in cut if window not in found], found, known)
        results = [found[window] for window in cut]
        failed = [isinstance(result, Failed) for result in results]
        if any(isinstance(result, Failed) and not any(result.seams) for result in results):
            return None
        for place, (one, other) in enumerate(pairwise(results)):
            # Both windows must find the same overlap at their common seam.
            if isinstance(one, Made) and isinstance(other, Made) and one.halves[-1] != other.halves[0]:
                failed[place] = True
        if not any(failed):
            return [result for result in results if isinstance(result, Made)]
        cut = merged(cut, failed, reach)
        reach *= 2


def _make(
    way: Way,
    demands: Demands,
    smoothing: Smoothing,
    missing: list[Window],
    found: dict[Window, Made | Failed],
    known: Known | None,
) -> None:
    """Plan windows on all cores of the machine. If an earlier result of a window is known, use this result
    instead.
    """
    if known is not None:
        for window in missing:
            before = known.get(way, window, smoothing)
            if before is not None:
                found[window] = before
        missing = [window for window in missing if window not in found]
    results = mapped(lambda window: made(way, demands, window, smoothing), missing)
    for window, result in zip(missing, results, strict=True):
        found[window] = result
        if known is not None:
            known.keep(way, window, smoothing, result)


def _pieces(parts: Sequence[Made], segment: float) -> list[Piece]:
    """Return the planned motions of a chain: cut its curve at the times at which corners are passed."""
    control = np.concatenate([*(part.points[:-3] for part in parts[:-1]), parts[-1].points])
    control.setflags(write=False)
    pieces, begin = list[Piece](), 0
    for part in parts:
        ends, halves = (part.ends + begin).tolist(), part.halves.tolist()
        for place, (share, least) in enumerate(zip(part.shares, part.least.tolist(), strict=True)):
            curve = Curve(
                control[ends[place] : ends[place + 1] + 3],
                segment,
                share[halves[place] : len(share) - halves[place + 1]],
            )
            pieces.append(Piece(curve, 2 * halves[place + 1], share, least=least))
        begin = ends[-1]
    pieces[-1] = replace(pieces[-1], overlap=None)
    return pieces


def is_one_path(links: Sequence[Link]) -> bool:
    """Return True if a chain can be planned as one path: all its motions move one frame along Cartesian
    paths.

    None of the motions may have a given duration, or a motion profile without a cruise.
    """
    first = links[0].path
    return all(
        isinstance(link.path, CartesianPath)
        and isinstance(first, CartesianPath)
        and np.array_equal(link.path.flange_from_moving, first.flange_from_moving)
        and link.duration is None
        and link.profile.has_cruise
        and (link.corner is None or link.corner.reach is None)
        for link in links
    )


def _likeliest(demands: Demands, grid: Grid) -> Iterator[Smoothing]:
    """Yield the smoothings to try for a chain, the one with the shortest estimated duration first. If
    estimates are about equal, the longer segments come first.
    """
    candidates = []
    for order, segment in enumerate(_segments(grid)):
        for widths in _WIDTHS:
            smoothing = Smoothing(segment, widths)
            ceiling, slope, _ = demands.ceilings(smoothing)
            # Estimate the duration: that of the law, plus about the time that the moving averages add at both
            # ends.
            duration = Law.fastest(demands.s, ceiling, slope).duration
            candidates.append((duration + smoothing.reach * segment, order, sum(widths), smoothing))
    while candidates:
        least = _ENOUGH * min(one[0] for one in candidates)
        best = min((one for one in candidates if one[0] <= least), key=lambda one: one[1:3])
        candidates.remove(best)
        yield best[3]
