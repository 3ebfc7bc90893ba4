"""Turn point clouds into bodies: the cubes of a grid that contain points, as one closed mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen

Array = NDArray[np.float64]

_MOST_CELLS = 1 << 60
"""Largest number of cells of the box around all points, so that each cell can be numbered."""


@frozen(eq=False)
class Voxels:
    """The cubes of a grid that contain points of a cloud.

    Attributes:
        triangles: (T, 3, 3) the triangles of the cubes' outer faces.
        cubes: number of cubes.
    """

    triangles: Array
    cubes: int


@frozen
class TooMany:
    """The result if a body would have too many triangles because its cells are too small.

    Attributes:
        triangles: number of the triangles; 0 if there are so many cubes that they can't be numbered.
    """

    triangles: int


def voxels_of(points: Array, edge: float, most: int) -> Voxels | TooMany:
    """Return the cubes of a grid that contain points, as a closed mesh, unless it has too many triangles.

    Each point is inside a cube or on its faces. Each edge of the mesh belongs to two or four triangles. The
    mesh is therefore closed, and is treated as solid.

    Args:
        points: (N, 3), finite, at least one.
        edge: edge length of a cube. The coordinates of the cubes' faces are multiples of it.
        most: largest number of triangles.
    """
    with np.errstate(over="ignore"):
        places = np.floor(points / edge)
    low = places.min(axis=0) - 1.0
    # an additional cell on each side gives each cube a neighbour in every direction
    sizes = [int(one) for one in places.max(axis=0) - low + 2.0]
    if (
        not np.isfinite(low).all()
        or max(abs(low).max(), *sizes) >= _EXACT
        or sizes[0] * sizes[1] * sizes[2] >= _MOST_CELLS
    ):
        return TooMany(0)
    strides = np.array([sizes[1] * sizes[2], sizes[2], 1])
    cells = np.unique((places - low).astype(np.int64) @ strides)
    faces = [(axis, side) for axis in range(3) for side in (0, 1)]
    outer = [_without(cells, cells + (2 * side - 1) * strides[axis]) for axis, side in faces]
    count = 2 * sum(len(one) for one in outer)
    if count > most:
        return TooMany(count)
    triangles = []
    for one, (axis, side) in zip(outer, faces, strict=True):
        at = np.stack((one // strides[0], one // strides[1] % sizes[1], one % sizes[2]), axis=1) + low
        triangles.append((at[:, None, None, :] + _face(axis, side)).reshape(-1, 3, 3))
    return Voxels(np.concatenate(triangles) * edge, len(cells))


def _without(cells: NDArray[np.int64], beyond: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return those of the sorted `cells` whose neighbour isn't one of the cells. The neighbour of each cell
    is the entry of `beyond` at the same position.
    """
    row = np.minimum(np.searchsorted(cells, beyond), len(cells) - 1)
    outer: NDArray[np.int64] = cells[cells[row] != beyond]
    return outer


_EXACT = float(1 << 52)
"""Bound below which floats represent integers exactly."""


def _face(axis: int, side: int) -> Array:
    """Return the two triangles (2, 3, 3) of a face of the unit cube.

    Seen from outside, their corners are in counterclockwise order.

    Args:
        axis: axis of the face's normal: 0, 1 or 2.
        side: 0 for the face at 0, 1 for the face at 1.
    """
    first, second = (axis + 1) % 3, (axis + 2) % 3
    corners = np.zeros((4, 3))
    corners[:, axis] = side
    corners[[1, 2], first] = 1.0
    corners[[2, 3], second] = 1.0
    order = ((0, 1, 2), (0, 2, 3)) if side else ((0, 2, 1), (0, 3, 2))
    found: Array = corners[np.array(order)]
    return found
