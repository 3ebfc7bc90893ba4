"""Draw fewer points of a path, without a visible change of its shape or colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array
from yarclang.view.stage import Rows, Way

FINEST = 5e-5
"""Largest distance of drawn lines from the path [m]. If there would be too many lines, a larger distance
is allowed.
"""
_FINEST_SHADE, _COARSEST_SHADE = 0.02, 0.2
"""Largest difference in colour between drawn lines and the path, as a share of the colour scale. The second
value applies if there would be too many lines. It is small enough that short slow sections stay visible.
"""
MOST_LINES = 20_000
"""Largest number of lines that a browser draws easily, even without a graphics card."""
_TOGETHER = 1e-9
"""Distance below which two points count as the same point [m]."""
_BLOCK = 512
"""Number of points in a block. Points are thinned only within blocks."""


@frozen(eq=False)
class Drawn:
    """The line segments that are drawn for a path.

    Attributes:
        first: (L,) numbers of the path points at which the segments begin.
        second: (L,) numbers of the path points at which the segments end.
        off: largest distance of the segments from the path [m].
    """

    first: Rows
    second: Rows
    off: float


def drawn_lines(way: Way, values: Array | None = None, most: float = 1.0, lines: int = MOST_LINES) -> Drawn:
    """Choose the line segments to draw for a path, so that few segments approximate its many points.

    Args:
        way: the path.
        values: (N,) values that colour the path's points; None for a single colour.
        most: value at the end of the colour scale.
        lines: largest number of segments; more only if the path has more separate sections, which have
            one segment each.

    Returns:
        Segments in the order of the path.
    """
    begins, ends = _runs(way)
    shades = np.zeros(len(way.points)) if values is None else np.clip(values / max(most, 1e-12), 0.0, 1.0)
    coarser = 1.0
    while True:
        shade = min(_FINEST_SHADE * coarser, _COARSEST_SHADE)
        kept = _kept(way.points, shades, begins, ends, FINEST * coarser, shade)
        rows = np.flatnonzero(kept)
        joined = ~np.isin(rows[:-1], ends)
        if joined.sum() <= lines or coarser > _COARSEST:
            return Drawn(rows[:-1][joined], rows[1:][joined], FINEST * coarser)
        coarser *= 2.0


_COARSEST = 4_096.0


def exact_lines(way: Way) -> Rows:
    """Return the numbers (L,) of the path points that are connected to the next point by a line."""
    first = np.arange(max(len(way.points) - 1, 0))
    kept: Rows = first[~np.isin(first + 1, way.breaks)]
    return kept


def _runs(way: Way) -> tuple[Rows, Rows]:
    """Return the indices of the first and of the last point of each connected section of a path.

    If a section begins where the previous one ends, the two count as one.
    """
    inner = way.breaks[1:-1]
    apart = np.abs(way.points[inner] - way.points[inner - 1]).max(axis=1, initial=0.0) > _TOGETHER
    cuts = inner[apart]
    return np.concatenate((way.breaks[:1], cuts)), np.concatenate((cuts, way.breaks[-1:])) - 1


def _kept(
    points: Array, shades: Array, begins: Rows, ends: Rows, off: float, shade: float
) -> NDArray[np.bool_]:
    """Return a mask (N,) of the path points between which line segments are drawn.

    Args:
        points: (N, 3) points of the path [m].
        shades: (N,) colours of the points, from 0 to 1.
        begins: first points of the path's connected sections.
        ends: last points of these sections.
        off: largest allowed distance of the segments from the path [m].
        shade: largest allowed difference in colour between a segment and the path.
    """
    kept = np.zeros(len(points), dtype=np.bool_)
    kept[begins] = kept[ends] = True
    kept[::_BLOCK] = True
    rows = np.flatnonzero(kept)
    pairs = ~np.isin(rows[:-1], ends)
    first, second = rows[:-1][pairs], rows[1:][pairs]
    while True:
        long = second - first > 1
        first, second = first[long], second[long]
        if not len(first):
            return kept
        go_on()
        sizes = second - first - 1
        line = np.repeat(np.arange(len(first)), sizes)
        begin = np.cumsum(sizes) - sizes
        inside = np.arange(len(line)) - begin[line] + first[line] + 1
        wrong = _wrong(points, shades, first[line], second[line], inside, off, shade)
        worst = np.maximum.reduceat(wrong, begin)
        split = np.flatnonzero(worst > 1.0)
        if not len(split):
            return kept
        _, where = np.unique(np.append(line[wrong == worst[line]], -1), return_index=True)
        middle = inside[wrong == worst[line]][where[1:]][split]
        kept[middle] = True
        first, second = (
            np.concatenate((first[split], middle)),
            np.concatenate((middle, second[split])),
        )


def _wrong(
    points: Array, shades: Array, first: Rows, second: Rows, inside: Rows, off: float, shade: float
) -> Array:
    """Return the deviations of path points from line segments that replace the path, in position or colour,
    as multiples (M,) of the tolerances.

    Args:
        points: (N, 3) points of the path [m].
        shades: (N,) colours of these points, from 0 to 1.
        first: (M,) indices of the points at which the segments begin.
        second: (M,) indices of the points at which the segments end.
        inside: (M,) indices of the points to compare with the segments.
        off: tolerance of the distance [m].
        shade: tolerance of the colour.
    """
    chord, arm = points[second] - points[first], points[inside] - points[first]
    square = np.einsum("ni,ni->n", chord, chord)
    share = np.einsum("ni,ni->n", chord, arm) / np.where(square > 0.0, square, 1.0)
    share = np.clip(share, 0.0, 1.0)
    away = np.linalg.norm(arm - share[:, None] * chord, axis=1)
    between = shades[first] + share * (shades[second] - shades[first])
    wrong: Array = np.maximum(away / off, np.abs(shades[inside] - between) / shade)
    return wrong
