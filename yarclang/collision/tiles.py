"""Divide the triangles of a large mesh into tiles, whose distances are computed only if they may matter.

The library coal builds a tree of all triangles before the first distance, which takes seconds for a million
of them. Most motions pass only a small part of such a mesh, or none.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.shapes import Array

TILE = 4096
"""Number of triangles of a tile."""
_BITS = 20
"""Number of bits to which each coordinate is rounded when triangles are sorted along Morton's curve."""
_ROUNDED = 1e-9
"""Upper bound of the rounding in the distance of a tile's box [m]."""


class TiledMesh:
    """The triangles of a mesh, divided into tiles of neighbouring triangles.

    The distance to another shape is the least distance of any triangle. Tiles are examined in the order of
    the distances of their boxes, until no other box is nearer than the least distance found. The tree of a
    tile is built when the tile is first examined.
    """

    def __init__(self, corners: Array, faces: NDArray[np.int64]) -> None:
        """Divide a mesh into tiles.

        Args:
            corners: (V, 3) corners of the mesh [m].
            faces: (T, 3) the indices of the corners of each triangle, in an order that keeps neighbours
                together (`in_order`).
        """
        self.corners, self.faces = corners, faces
        begins = np.arange(0, len(faces), TILE)
        sides = [corners[faces[:, side]] for side in range(3)]
        self._low = np.minimum.reduceat(np.minimum.reduce(sides), begins)
        self._high = np.maximum.reduceat(np.maximum.reduce(sides), begins)
        self._trees: dict[int, Any] = {}
        self._whole: Any = None

    @property
    def built(self) -> int:
        """Number of tiles whose trees were built."""
        return len(self._trees)

    def whole(self) -> Any:
        """Return coal's model of all triangles of the mesh, built at the first call."""
        if self._whole is None:
            self._whole = modelled(self.corners, self.faces)
        return self._whole

    def distance(
        self, other: Any, pose: Any, around: tuple[Array, float], request: Any
    ) -> tuple[float, Array]:
        """Compute the distance from the mesh to another shape [m], and the unit vector towards this shape
        (3,).

        Args:
            other: the shape, as an object of coal.
            pose: the pose of the shape in the mesh's frame, as an object of coal.
            around: center (3,), in the mesh's frame, and radius of a sphere around the shape [m].
            request: the distance request for coal.
        """
        import coal

        center, radius = around
        # The distance of the sphere around the other shape from the box of a tile is a lower bound for all
        # triangles of the tile.
        outside = np.maximum(np.maximum(self._low - center, center - self._high), 0.0)
        bound = np.sqrt(np.einsum("ti,ti->t", outside, outside)) - radius - _ROUNDED
        best, normal = np.inf, np.zeros(3)
        answer, here = coal.DistanceResult(), coal.Transform3s()
        # Examine the nearest boxes first. A box farther than the best distance ends the search.
        for tile in np.argsort(bound).tolist():
            if bound[tile] >= best:
                break
            answer.clear()
            found = coal.distance(self._tree(tile), here, other, pose, request, answer)
            if found < best:
                best, normal = float(found), np.array(answer.normal)
        return best, normal

    def _tree(self, tile: int) -> Any:
        if tile not in self._trees:
            chosen, numbers = np.unique(self.faces[tile * TILE : (tile + 1) * TILE], return_inverse=True)
            self._trees[tile] = modelled(self.corners[chosen], numbers.reshape(-1, 3))
        return self._trees[tile]


def in_order(corners: Array, faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Sort triangles (T, 3) of corners (V, 3) so that neighbours are near each other in the array."""
    middles = (corners[faces[:, 0]] + corners[faces[:, 1]] + corners[faces[:, 2]]) / 3.0
    ordered: NDArray[np.int64] = faces[np.argsort(_places(middles), kind="stable")]
    return ordered


def _places(points: Array) -> NDArray[np.int64]:
    """Return the positions of points (T, 3) along Morton's curve, on which neighbouring points are near
    each other.
    """
    low, spread = points.min(axis=0), max(float(np.ptp(points, axis=0).max()), 1e-30)
    cells = ((points - low) / spread * ((1 << _BITS) - 1)).astype(np.int64)
    place = np.zeros(len(points), dtype=np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            # Interleave the bits of the three coordinates.
            place |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return place


def modelled(corners: Array, faces: NDArray[np.int64]) -> Any:
    """Return coal's model of corners (V, 3) [m] and triangles (T, 3)."""
    import coal

    model = coal.BVHModelOBBRSS()
    model.beginModel(len(faces), len(corners))
    model.addVertices(corners)
    model.addTriangles(faces)
    model.endModel()
    return model
