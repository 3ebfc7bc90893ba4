"""Divide a closed mesh into convex pieces that together contain the solid.

The box around the mesh is cut by planes perpendicular to its axes into cells. The piece of a cell is the
convex hull of two kinds of points: the corners of the parts of triangles in the cell, and those corners of
the cell that are inside the solid.

This hull contains P, the part of the solid in the cell. Proof: let p be an extreme point of P. If p is on the
surface of the solid, it is in the part of a triangle that is in the cell. If p is inside the solid, it is
also an extreme point of the cell, that is, one of the cell's corners. A triangle in the border between two
cells belongs only to the cell on the side of the solid. The other cell needs the triangle's points only where
other triangles meet the triangle. So no piece lacks any part of the solid, whichever planes are chosen. The
planes are chosen so that the pieces are small.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.meshes.columns import Columns, filled

Array = NDArray[np.float64]

MOST_PIECES = 64
"""Largest number of pieces."""

_EVEN = 7
"""Number of evenly spaced planes across each axis that are tried as cuts of a cell."""
_FACES = 8
"""Number of planes across each axis that are tried at the largest faces of the mesh perpendicular to the
axis.
"""
_GRID = 32
"""Number of cells along each axis of the grid with which the solid's volume is measured."""
_ENOUGH = 0.02
"""A piece is not cut again if its excess volume (the part outside of the solid) is less than this share of
its own volume.
"""
_SOME = 4_000
"""Largest number of triangles that are used to choose the cuts."""
_WORTH = 0.1
"""If the best plane reduces the volume by less than this share of the excess volume, the cell is halved
instead.
"""
_TINY = 0.002
"""A piece is not cut again if its excess volume is less than this share of the volume of the whole hull."""
_INWARDS = 5e-7
"""A corner of a cell counts as inside the solid if a point near it may be inside. This is the distance of
that point from the cell's borders [m].
"""
_THIN = 1e-5
"""Least thickness of a piece [m]. Flat pieces, which contain only a part of the surface, are thickened."""


@frozen(eq=False)
class Piece:
    """A convex piece of a mesh.

    Attributes:
        low: corner of the piece's cell with the least coordinates (3,).
        high: corner of the piece's cell with the largest coordinates (3,).
        corners: (V, 3) the corners of the piece.
    """

    low: Array
    high: Array
    corners: Array


@frozen(eq=False)
class _Cell:
    low: Array
    high: Array
    triangles: Array
    volume: float
    excess: float


def pieces_of(triangles: Array, most: int) -> tuple[Piece, ...]:
    """Return convex pieces that contain a solid. The result is the same each time for the same mesh.

    Args:
        triangles: (T, 3, 3) [m], which enclose the solid.
        most: largest number of pieces.
    """
    if np.einsum("ti,ti->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) < 0.0:
        triangles = triangles[:, ::-1]  # now counterclockwise, seen from outside
    columns = Columns(triangles)
    found = []
    for low, high in _cells(triangles, most):
        own = _within(triangles, low, high).reshape(-1, 3)
        corners = _corners(low, high)
        inwards = np.minimum(_INWARDS, (high - low) / 8.0)
        within = np.clip(corners, low + inwards, high - inwards)
        inside = [
            corner
            for corner, near in zip(corners, within, strict=True)
            if columns.may_contain(near) or columns.contains(corner)
        ]
        held = np.concatenate((own, np.array(inside).reshape(-1, 3)))
        # `held` is never empty, since each cell contains parts of triangles.
        found.append(Piece(low, high, _outer(_thick(held))))
    return tuple(found)


def _cells(triangles: Array, most: int) -> list[tuple[Array, Array]]:
    """Return the lowest and the highest corner of each of at most `most` cells, which together fill the box
    around triangles (T, 3, 3).
    """
    points = triangles.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    solid, middles = filled(triangles, low, high, _GRID)
    flats = _flats(triangles)
    order = np.random.default_rng(0).permutation(len(triangles))  # always the same order
    some = triangles[np.sort(order[:_SOME])]
    whole = _volume(_outer(some.reshape(-1, 3)))
    cells = [_measured(low, high, some, solid, middles)]
    while len(cells) < most:
        worst = max(range(len(cells)), key=lambda at: cells[at].excess)
        cell = cells[worst]
        if cell.excess <= max(_TINY * whole, _ENOUGH * cell.volume):
            break
        cut = _best_cut(cell, flats)
        if cut is None:
            cells[worst] = _Cell(cell.low, cell.high, cell.triangles, cell.volume, 0.0)
            continue
        axis, at = cut
        below, above = _cut(cell.triangles, axis, at)
        ends, begins = cell.high.copy(), cell.low.copy()
        ends[axis] = begins[axis] = at
        cells[worst] = _measured(cell.low, ends, below, solid, middles)
        cells.append(_measured(begins, cell.high, above, solid, middles))
    return [(cell.low, cell.high) for cell in cells]


def _within(triangles: Array, low: Array, high: Array) -> Array:
    """Return the parts of triangles (T, 3, 3) that are in a cell, as triangles (P, 3, 3)."""
    for axis in range(3):
        for at, above in ((float(low[axis]), True), (float(high[axis]), False)):
            triangles = _cut(triangles, axis, at)[above]
    return triangles


def _corners(low: Array, high: Array) -> Array:
    """Return the corners (8, 3) of a cell."""
    upper = np.array(np.meshgrid((0, 1), (0, 1), (0, 1), indexing="ij")).reshape(3, 8).T
    found: Array = np.where(upper == 1, high, low)
    return found


def _measured(low: Array, high: Array, triangles: Array, solid: NDArray[np.bool_], middles: Array) -> _Cell:
    """Return a cell with two volumes: of its convex piece, and, approximately, of the part of this piece
    outside of the solid.

    Args:
        low: the cell's corner with the least coordinates (3,).
        high: the cell's corner with the largest coordinates (3,).
        triangles: the parts of the mesh's triangles in the cell (T, 3, 3).
        solid: which cells of a measuring grid have their middle inside the solid (n, n, n).
        middles: the coordinates of the middles of this grid's cells along each axis (3, n).
    """
    if not len(triangles):
        return _Cell(low, high, triangles, 0.0, 0.0)
    points = triangles.reshape(-1, 3)
    rows = [np.flatnonzero((middles[axis] >= low[axis]) & (middles[axis] < high[axis])) for axis in range(3)]
    empty = np.argwhere(~solid[np.ix_(*rows)])
    at = np.stack([middles[axis][rows[axis]][empty[:, axis]] for axis in range(3)], axis=1)
    size = float(np.prod([row[1] - row[0] for row in middles]))
    return _Cell(low, high, triangles, _volume(points), size * _enclosed(points, at))


def _enclosed(points: Array, asked: Array) -> int:
    """Return how many of the points `asked` (A, 3) are in the convex hull of `points` (V, 3)."""
    faces = _faces(points)
    for some in np.array_split(faces, len(faces) // 64 + 1):
        asked = asked[(asked @ some[:, :3].T + some[:, 3] <= 0.0).all(axis=1)]
    return len(asked) if len(faces) else 0


def _faces(points: Array) -> Array:
    """Return the planes (F, 4) of the faces of the convex hull of points (V, 3), with normals that point
    outwards; none for a flat hull.
    """
    if len(points) < 4:
        return np.zeros((0, 4))
    from scipy.spatial import ConvexHull, QhullError

    try:
        found: Array = ConvexHull(points).equations
    except QhullError:
        return np.zeros((0, 4))
    return found


def _flats(triangles: Array) -> tuple[Array, ...]:
    """Return, for each axis, the coordinates of the largest faces of the mesh that are perpendicular to
    it.
    """
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(across, axis=1)
    found = []
    for axis in range(3):
        flat = (np.abs(across[:, axis]) > (1.0 - 1e-6) * area) & (area > 0.0)
        places, of = np.unique(np.round(triangles[flat, 0, axis], 9), return_inverse=True)
        sizes = np.bincount(of, area[flat], len(places))
        found.append(np.sort(places[np.argsort(-sizes, kind="stable")[: 4 * _FACES]]))
    return tuple(found)


def _best_cut(cell: _Cell, flats: tuple[Array, ...]) -> tuple[int, float] | None:
    """Return the plane that best cuts a cell in two: the axis to which it is perpendicular, and its
    coordinate on this axis.

    The best plane is the one for which the convex hulls of the two halves have the smallest volume in total;
    of equally good planes, the one nearest to the middle of the cell. If even the best plane reduces the
    volume only a little (`_WORTH`), as for a ring, the cell is halved instead: by the plane perpendicular to
    its longest edge, through the middle of this edge. The result is None if the cell is too thin to be cut.
    """
    points = cell.triangles.reshape(-1, 3)
    best: tuple[float, float, int, float] | None = None
    for axis in range(3):
        low, high = float(points[:, axis].min()), float(points[:, axis].max())
        wide = high - low
        if wide <= 4.0 * _THIN:
            continue
        even = low + wide * np.arange(1, _EVEN + 1) / (_EVEN + 1)
        own = flats[axis][(flats[axis] > low + 2.0 * _THIN) & (flats[axis] < high - 2.0 * _THIN)]
        places = np.unique(np.concatenate((even, own[:: max(1, len(own) // _FACES)])))
        for at, volume in zip(places.tolist(), _volumes(cell.triangles, axis, places), strict=True):
            off = abs(2.0 * (at - low) / wide - 1.0)
            rank = (round(volume / cell.volume, 6) if cell.volume else 0.0, round(off, 6), axis, at)
            best = rank if best is None else min(best, rank)
    if best is None or cell.volume * (1.0 - best[0]) > _WORTH * cell.excess:
        return None if best is None else best[2:]
    longest = int(np.argmax(np.ptp(points, axis=0)))
    return longest, float(points[:, longest].min() + points[:, longest].max()) / 2.0


def _volumes(triangles: Array, axis: int, places: Array) -> list[float]:
    """Return the volume of the two pieces together into which a plane cuts a cell. The result has one number
    for each of several planes perpendicular to an axis, in rising order.
    """
    layers, rest = [], triangles
    for at in places.tolist():
        below, rest = _cut(rest, axis, at)
        layers.append(_outer(below.reshape(-1, 3)))
    layers.append(_outer(rest.reshape(-1, 3)))
    before, after = [_growing(layers), _growing(layers[::-1])[::-1]]
    return [one + other for one, other in zip(before[:-1], after[1:], strict=True)]


def _growing(layers: list[Array]) -> list[float]:
    """Return the volumes of the convex hulls of the first layer of points, of the first two layers together,
    and so on.
    """
    found, points = [], np.zeros((0, 3))
    for layer in layers:
        points = _outer(np.concatenate((points, layer)))
        found.append(_volume(points))
    return found


def _cut(triangles: Array, axis: int, at: float) -> tuple[Array, Array]:
    """Cut triangles by the plane perpendicular to an axis at the coordinate `at`.

    A triangle in the plane belongs to the side on which the solid is. The order of its corners shows which
    side this is.

    Returns:
        The parts of the triangles below and above the plane, each as triangles (T, 3, 3).
    """
    side = triangles[:, :, axis] - at
    least, most = side.min(axis=1), side.max(axis=1)
    flat = (least == 0.0) & (most == 0.0)
    upwards = np.zeros(len(flat), dtype=np.bool_)
    upwards[flat] = _upwards(triangles[flat], axis)
    below = triangles[np.where(flat, upwards, most <= 0.0)]
    above = triangles[np.where(flat, ~upwards, (least >= 0.0) & (most > 0.0))]
    crossing = np.flatnonzero((least < 0.0) & (most > 0.0))
    if not len(crossing):
        return below, above
    # rotate the corners of each triangle, so that its first corner is alone on its side, or in the plane
    # between the other two
    three, signs = triangles[crossing], np.sign(side[crossing])
    alone = np.where(
        (signs == 0.0).any(axis=1),
        np.argmin(np.abs(signs), axis=1),
        np.argmax(signs == -np.sign(signs.sum(axis=1))[:, None], axis=1),
    )
    order = (alone[:, None] + np.arange(3)) % 3
    three = np.take_along_axis(three, order[:, :, None], axis=1)
    signs = np.take_along_axis(signs, order, axis=1)
    on = signs[:, 0] == 0.0
    low, high = [below], [above]
    a, b, c = (three[on, number] for number in range(3))
    middle = _meeting(b, c, axis, at)
    for halves, sign in (((a, b, middle), signs[on, 1]), ((a, middle, c), signs[on, 2])):
        _share(np.stack(halves, axis=1), sign, low, high)
    a, b, c = (three[~on, number] for number in range(3))
    first, second = _meeting(a, b, axis, at), _meeting(a, c, axis, at)
    tip, base = signs[~on, 0], -signs[~on, 0]
    _share(np.stack((a, first, second), axis=1), tip, low, high)
    _share(np.stack((first, b, c), axis=1), base, low, high)
    _share(np.stack((first, c, second), axis=1), base, low, high)
    return np.concatenate(low), np.concatenate(high)


def _upwards(triangles: Array, axis: int) -> NDArray[np.bool_]:
    """Return a mask of the triangles (T, 3, 3) whose normals have a positive component along an axis."""
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    one, other = (axis + 1) % 3, (axis + 2) % 3
    found: NDArray[np.bool_] = first[:, one] * second[:, other] > first[:, other] * second[:, one]
    return found


def _share(parts: Array, sign: Array, low: list[Array], high: list[Array]) -> None:
    low.append(parts[sign < 0.0])
    high.append(parts[sign > 0.0])


def _meeting(one: Array, other: Array, axis: int, at: float) -> Array:
    """Return the points (T, 3) at which edges of triangles meet the cutting plane. The result for an edge
    doesn't depend on the edge's direction.
    """
    swap = (one[:, axis] > other[:, axis])[:, None]
    first, second = np.where(swap, other, one), np.where(swap, one, other)
    share = (at - first[:, axis]) / (second[:, axis] - first[:, axis])
    found: Array = first + (second - first) * share[:, None]
    found = np.clip(found, np.minimum(one, other), np.maximum(one, other))
    found[:, axis] = at
    return found


def _outer(points: Array) -> Array:
    """Return the corners of the convex hull of points (V, 3). If the points are in a plane, return all
    distinct points.
    """
    points = np.unique(points, axis=0)
    if len(points) <= 4:
        return points
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[np.sort(ConvexHull(points).vertices)])
    except QhullError:
        return points


def _volume(points: Array) -> float:
    """Return the volume of the convex hull of points (V, 3); 0 if the points are in a plane."""
    if len(points) < 4:
        return 0.0
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(points).volume)
    except QhullError:
        return 0.0


def _thick(points: Array) -> Array:
    """Return points (V, 3) with a thickness of at least `_THIN` in each direction: where they are thinner,
    each point is replaced by two, shifted to both sides.
    """
    middle = points.mean(axis=0)
    _, _, axes = np.linalg.svd(points - middle, full_matrices=False) if len(points) > 2 else (0, 0, np.eye(3))
    for axis in axes:
        along = points @ axis
        if np.ptp(along) < _THIN:
            points = np.concatenate((points - _THIN * axis, points + _THIN * axis))
    return points
