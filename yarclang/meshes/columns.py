"""Decide if points are inside a closed triangle mesh, by counting the triangles that a straight line from
each point crosses.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_DIRECTIONS = 4
"""Number of directions that are tried for a point. If none gives a result, the point is neither certainly
inside nor certainly outside.
"""
_UNSURE = 1e-9
"""Largest distance between a line and an edge of a triangle at which the line may meet the edge, as a share
of the size of the mesh.
"""


class Columns:
    """A closed triangle mesh, with the directions of the lines by which points are tested. The directions are
    fixed, and chosen so that a face of a machine is hardly ever parallel to one of them.
    """

    def __init__(self, triangles: Array) -> None:
        """Store the triangles (T, 3, 3) of the mesh."""
        self._triangles = triangles
        self._size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max()) or 1.0
        self._seen: dict[int, tuple[Array, Array, Array]] = {}

    def may_contain(self, point: Array) -> bool:
        """Return False only if a point (3,) is certainly outside of the mesh."""
        return self._inside(point) is not False

    def contains(self, point: Array) -> bool:
        """Return True only if a point (3,) is certainly inside the mesh."""
        return self._inside(point) is True

    def _inside(self, point: Array) -> bool | None:
        for number in range(_DIRECTIONS):
            turn = _turn(number)
            turned, low, high = self._turned(number)
            at = turn @ point
            slack = _UNSURE * self._size
            near = (low[:, 0] <= at[0] + slack) & (high[:, 0] >= at[0] - slack)
            near &= (low[:, 1] <= at[1] + slack) & (high[:, 1] >= at[1] - slack)
            near &= high[:, 2] >= at[2] - slack
            crossed = _crossings(turned[near], at, slack)
            if crossed is not None:
                return len(crossed) % 2 == 1 or bool(crossed.sum())
        return None

    def _turned(self, number: int) -> tuple[Array, Array, Array]:
        if number not in self._seen:
            turned = self._triangles @ _turn(number).T
            self._seen[number] = turned, turned.min(axis=1), turned.max(axis=1)
        return self._seen[number]


def _turn(number: int) -> Array:
    """Return the rotation (3, 3) that turns direction number `number` of the test lines upwards; its last row
    is this direction.
    """
    angles = np.array([0.371, 0.743, 1.181]) * (number + 1)
    (a, b, c), (d, e, f) = np.cos(angles), np.sin(angles)
    first = np.array([[a, -d, 0.0], [d, a, 0.0], [0.0, 0.0, 1.0]])
    second = np.array([[1.0, 0.0, 0.0], [0.0, b, -e], [0.0, e, b]])
    third = np.array([[c, -f, 0.0], [f, c, 0.0], [0.0, 0.0, 1.0]])
    found: Array = first @ second @ third
    return found


def _crossings(triangles: Array, at: Array, slack: float) -> Array | None:
    """Return an entry for each triangle that the upward line from a point crosses: 1 if the triangle's
    corners are in counterclockwise order seen from above, otherwise -1.

    Return None if the line may meet an edge of a triangle, or if the point may be on a triangle.

    Args:
        triangles: (T, 3, 3).
        at: the point (3,).
        slack: distance up to which two points or lines may coincide.
    """
    if not len(triangles):
        return np.zeros(0)
    flat = triangles[:, :, :2] - at[:2]
    turns, reaches = [], []
    for one, other in ((1, 2), (2, 0), (0, 1)):
        along = flat[:, other] - flat[:, one]
        turns.append(flat[:, one, 0] * flat[:, other, 1] - flat[:, one, 1] * flat[:, other, 0])
        reaches.append(np.hypot(along[:, 0], along[:, 1]) * slack)
    signs, unsure = np.array(turns), np.abs(turns) <= np.array(reaches)
    # a triangle isn't crossed if the line certainly passes two of its edges on opposite sides, even if the
    # third edge is unsure
    plus, minus = (signs > 0.0) & ~unsure, (signs < 0.0) & ~unsure
    hit = ~(plus.any(axis=0) & minus.any(axis=0))
    if (hit & unsure.any(axis=0)).any():
        return None
    area = signs[:, hit].sum(axis=0)
    height = np.einsum("it,ti->t", signs[:, hit], triangles[hit][:, :, 2]) / area - at[2]
    across = np.ptp(triangles[hit], axis=1).max(axis=1, initial=0.0)
    # the height on a steep triangle is less certain, by the ratio of its extent to its width seen from above
    slopes = slack * (1.0 + across**2 / np.abs(area))
    if (np.abs(height) <= slopes).any():
        return None
    found: Array = np.sign(area[height > 0.0])
    return found


def filled(triangles: Array, low: Array, high: Array, count: int) -> tuple[NDArray[np.bool_], Array]:
    """Return which cells of a grid have their middle inside a closed triangle mesh. The result is
    approximate: use it for measuring, not for proofs.

    Args:
        triangles: (T, 3, 3).
        low: corner of the grid with the least coordinates (3,).
        high: corner of the grid with the largest coordinates (3,).
        count: number of cells along each axis, n.

    Returns:
        The mask of the cells (n, n, n), and the coordinates of their middles along each axis (3, n).
    """
    share = (np.arange(count) + 0.5) / count
    middles = low[:, None] + (high - low)[:, None] * share
    least, most = triangles.min(axis=1), triangles.max(axis=1)
    mask = np.zeros((count, count, count), dtype=np.bool_)
    shift = 1e-4 * (high - low) / count
    for row, x in enumerate((middles[0] + shift[0]).tolist()):
        here = (least[:, 0] <= x) & (most[:, 0] >= x)
        own, under, over = triangles[here], least[here, 1], most[here, 1]
        for column, y in enumerate((middles[1] + 1.7 * shift[1]).tolist()):
            three = own[(under <= y) & (over >= y)]
            flat = three[:, :, :2] - np.array([x, y])
            turns = np.array(
                [
                    flat[:, one, 0] * flat[:, other, 1] - flat[:, one, 1] * flat[:, other, 0]
                    for one, other in ((1, 2), (2, 0), (0, 1))
                ]
            ).reshape(3, -1)
            hit = (turns > 0.0).all(axis=0) | (turns < 0.0).all(axis=0)
            heights = np.einsum("it,ti->t", turns[:, hit], three[hit][:, :, 2]) / turns[:, hit].sum(axis=0)
            mask[row, column] = (np.sort(heights)[:, None] < middles[2]).sum(axis=0) % 2 == 1
    return mask, middles
