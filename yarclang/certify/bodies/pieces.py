"""Proof that the convex pieces of a mesh contain the mesh.

The judge checks the division by a method of its own. Each piece belongs to a cell, a box, which the judge
makes a little smaller. The judge computes all points that can be extreme points of the part of the solid in
this cell: corners of triangles inside the cell, points where edges of triangles meet the cell's borders,
points where the cell's edges meet triangles, and those corners of the cell that are inside the solid. A piece
is convex: if it contains all of these points, it contains the part of the solid in its cell. The cells must
fill the box around the mesh without overlapping.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.geometry import Geometry, UnreadableError, geometry_of
from yarclang.collision.scene import geometries
from yarclang.diagnostics import Diagnostic
from yarclang.robot.model import Array, Robot
from yarclang.shapes import Mesh, Shape
from yarclang.source import SourceFile
from yarclang.units import MM

ALLOWED = 1e-8
"""Distance by which a point may be outside of its piece because of rounding [m]."""
_BORDER = 1e-6
"""Thickness of the borders between the cells of a mesh, where nothing is proved [m].

It is no larger than the error of computed distances.
"""
_ROUNDED = 1e-9
"""Largest allowed difference between a box's volume and the total volume of its cells, as a fraction of the
box's volume.
"""


def incomplete(robot: Robot, cell: Cell | None, source: SourceFile) -> Iterator[Diagnostic]:
    """Yield a finding for each mesh whose pieces don't contain it."""
    named: list[tuple[str, Shape]] = [(one.link, one.shape) for one in robot.shapes]
    named += [(tool.name, one.shape) for tool in robot.tools for one in tool.shapes]
    if cell is not None:
        bodies = (*cell.obstacles, *(part.body for part in cell.parts))
        named += [(one.name, one.shape) for one in bodies]
    for name, shape in dict.fromkeys(named):
        if not isinstance(shape, Mesh) or shape.pieces < 2:
            continue
        off = _off(shape)
        if off > ALLOWED:
            lacks = (
                f"leave up to {off / MM:.3g} mm of it uncovered"
                if np.isfinite(off)
                else "leave a gap between them"
            )
            message = f"the {shape.pieces} pieces of the mesh {shape.path.name} of {name} {lacks}"
            yield Diagnostic("Y0961", message, source, help=_REPORT)


_REPORT = (
    "nothing is written: this is an error of yarclang; please report it with the mesh, and remove the key "
    "`pieces` until then"
)


@lru_cache(maxsize=64)
def _off(shape: Mesh) -> float:
    pieces = geometries(shape, True)
    try:
        skin = geometry_of(replace(shape, pieces=0)).skin
    except UnreadableError:
        skin = None
    # A mesh that has changed or can't be read gets its finding when the scene is made.
    return 0.0 if skin is None or isinstance(pieces, UnreadableError) else lacking(skin, pieces)


def lacking(triangles: Array, pieces: tuple[Geometry, ...]) -> float:
    """Return the largest distance [m] by which a solid sticks out of its convex pieces.

    Args:
        triangles: (T, 3, 3) triangles, which enclose the solid.
        pieces: the convex pieces, each with its cell.

    Returns:
        The distance; infinite if the cells don't fill the box around the triangles, or overlap.
    """
    low = np.array([one.cell[0] for one in pieces if one.cell is not None])
    high = np.array([one.cell[1] for one in pieces if one.cell is not None])
    if len(low) != len(pieces):
        return np.inf
    lower, upper = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    if not _fill(low, high, lower, upper):
        return np.inf
    return max(_outside(triangles, *each) for each in zip(low, high, pieces, strict=True))


def _fill(low: Array, high: Array, lower: Array, upper: Array) -> bool:
    """Return True if cells fill a box without overlapping.

    Args:
        low: (N, 3) lower corners of the cells [m].
        high: (N, 3) upper corners of the cells [m].
        lower: (3,) lower corner of the box [m].
        upper: (3,) upper corner of the box [m].
    """
    if (low < lower).any() or (high > upper).any() or (low > high).any():
        return False
    for number in range(len(low) - 1):
        # Two boxes overlap if they share an interval on all three axes.
        shared = np.minimum(high[number], high[number + 1 :]) - np.maximum(low[number], low[number + 1 :])
        if (shared > 0.0).all(axis=1).any():
            return False
    # Cells in the box that don't overlap fill it if their volumes add up to that of the box.
    whole = float(np.prod(upper - lower))
    return abs(float(np.prod(high - low, axis=1).sum()) - whole) <= _ROUNDED * whole


def _outside(triangles: Array, low: Array, high: Array, piece: Geometry) -> float:
    """Return the largest distance [m] by which the solid in one cell sticks out of the cell's piece."""
    border = np.minimum(_BORDER, (high - low) / 4.0)
    low, high = low + border, high - border
    near = ((triangles.max(axis=1) >= low) & (triangles.min(axis=1) <= high)).all(axis=1)
    corners = np.array(list(product(*zip(low, high, strict=True))))
    filled = np.array([_is_filled(triangles, corner) for corner in corners])
    points = np.concatenate((_points(triangles[near], low, high), corners[filled]))
    return _beyond(piece, points) if len(points) else 0.0


def _points(triangles: Array, low: Array, high: Array) -> Array:
    """Return the points (P, 3) of triangles that can be extreme points of the part of the solid in a cell.

    Corners of the cell inside the solid are not among them.
    """
    candidates = [triangles.reshape(-1, 3)]
    # Add the points at which edges of triangles cross the planes of the cell's faces.
    for axis, at in product(range(3), (low, high)):
        for one, other in ((0, 1), (1, 2), (2, 0)):
            first, second = triangles[:, one], triangles[:, other]
            below, above = first[:, axis] - at[axis], second[:, axis] - at[axis]
            # An edge crosses the plane if its ends have signed distances of opposite signs; the crossing
            # divides the edge in their ratio.
            cut = below * above < 0.0
            share = below[cut] / (below[cut] - above[cut])
            candidates.append(first[cut] + share[:, None] * (second[cut] - first[cut]))
    # Add the points at which triangles meet the lines of the cell's edges. Triangles parallel to a line are
    # left out, since their edges are covered above.
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    for axis in range(3):
        side, top = (axis + 1) % 3, (axis + 2) % 3
        across = np.abs(normals[:, axis]) > 0.0
        # Parallel to this axis, the cell has four edges: one for each pair of the other two coordinates.
        for at, over in product((low[side], high[side]), (low[top], high[top])):
            candidates.append(_on_line(triangles[across], axis, (at, over)))
    points = np.concatenate(candidates)
    within = ((points >= low - ALLOWED) & (points <= high + ALLOWED)).all(axis=1)
    found_within: Array = points[within]
    return found_within


def _on_line(triangles: Array, axis: int, at: tuple[float, float]) -> Array:
    """Return the points (P, 3) at which a line parallel to an axis meets triangles.

    Args:
        triangles: (T, 3, 3).
        axis: index of the axis.
        at: the line's other two coordinates, in cyclic order after `axis` [m].
    """
    side, top = (axis + 1) % 3, (axis + 2) % 3
    # Project the triangles along the axis, with the line at the origin. Each row of `turns` is twice the
    # signed area of the triangle between the line and one edge.
    flat = triangles[:, :, [side, top]] - np.array(at)
    turns = np.stack(
        [
            flat[:, one, 0] * flat[:, other, 1] - flat[:, one, 1] * flat[:, other, 0]
            for one, other in ((1, 2), (2, 0), (0, 1))
        ]
    )
    # In the projection along the axis, the point is inside if it is on the same side of all three edges. The
    # same areas are the barycentric coordinates of the point.
    hit = (turns >= 0.0).all(axis=0) | (turns <= 0.0).all(axis=0)
    weights = turns[:, hit] / turns[:, hit].sum(axis=0)
    points: Array = np.einsum("it,tix->tx", weights, triangles[hit])
    points[:, side], points[:, top] = at
    return points


def _is_filled(triangles: Array, point: Array) -> bool:
    """Return True if a point is inside a solid: then the solid angles of its triangles add up to 4 pi.

    A triangle's solid angle is 2 atan2(volume, rest) (Van Oosterom and Strackee 1983).
    """
    a, b, c = (triangles[:, number] - point for number in range(3))
    # Let a, b, c be the vectors from the point to a triangle's corners. The triangle's solid angle follows
    # from tan(angle / 2) = a . (b x c) / (|a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b|).
    one, other, third = (np.sqrt((arm * arm).sum(axis=1)) for arm in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=1)
    rest = one * other * third + (a * b).sum(axis=1) * third
    rest += (b * c).sum(axis=1) * one + (c * a).sum(axis=1) * other
    return bool(abs(2.0 * np.arctan2(volume, rest).sum()) > 2.0 * np.pi)


def _beyond(piece: Geometry, points: Array) -> float:
    """Return the largest distance of points (P, 3) beyond a face of a piece [m]."""
    from scipy.spatial import ConvexHull

    assert piece.corners is not None  # each piece has corners
    # Each face is given as n . x + offset <= 0 for points x inside, with the unit normal n.
    faces = ConvexHull(piece.corners + piece.middle).equations
    parts = np.array_split(np.unique(points, axis=0), len(points) * len(faces) // 10_000_000 + 1)
    return max(float((part @ faces[:, :3].T + faces[:, 3]).max()) for part in parts if len(part))
