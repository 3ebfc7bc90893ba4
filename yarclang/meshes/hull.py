"""Write the convex hull of a large mesh as a small file."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.meshes.obj import obj_corners
from yarclang.meshes.stl import stl_corners

_FLAT = 1e-6
"""Thickness, as a share of the size of a mesh, below which the mesh counts as flat and has no hull."""

MOST_CORNERS = 50_000
"""Largest number of corners of a hull. A larger hull is replaced by a body with fewer corners, bounded by
planes around the hull, since coal (the collision library) fails or is slow with most larger hulls.
"""

_ROUNDED = 1e-9
"""Upper bound of the rounding in the extent of a body [m, or the mesh's unit]."""

_DIRECTIONS = 1000
"""Number of planes that bound the body that replaces a large hull. This body is less than 1 % larger than the
hull.
"""

_HEAD = """ply
format binary_little_endian 1.0
comment the convex hull of another mesh
element vertex {corners}
property double x
property double y
property double z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def hull_file(suffix: str, content: bytes) -> bytes | None:
    """Return a PLY file of the convex hull of a mesh.

    The file has the exact corners of the hull. A hull with very many corners is replaced by a slightly larger
    body: the body between planes around the hull.

    Args:
        suffix: suffix of the file's name, in any case, with its dot.
        content: the file.

    Returns:
        The file; None for a flat mesh, for another format, and for a file whose corners can't be read as an
        array.
    """
    look = {".stl": stl_corners, ".obj": obj_corners}.get(suffix.lower())
    corners = look(content) if look is not None else None
    if corners is None or not len(corners):
        return None
    spread = np.ptp(corners, axis=0).max()
    if np.linalg.eigvalsh(np.cov(corners.T))[0] <= (_FLAT * spread) ** 2:
        return None
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(corners)
    except QhullError:
        return None
    if len(hull.vertices) > MOST_CORNERS:
        corners = cover(corners[hull.vertices], _DIRECTIONS)
        hull = ConvexHull(corners)
    number = np.zeros(len(corners), np.int32)
    number[hull.vertices] = np.arange(len(hull.vertices))
    faces = hull.simplices
    a, b, c = (corners[faces[:, side]] for side in range(3))
    inwards = np.einsum("ti,ti->t", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces[inwards] = faces[inwards][:, [0, 2, 1]]
    rows = np.zeros(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, number[faces]
    head = _HEAD.format(corners=len(hull.vertices), faces=len(faces))
    outer: bytes = corners[hull.vertices].astype("<f8").tobytes()
    return head.encode() + outer + rows.tobytes()


def cover(corners: NDArray[np.float64], directions: int) -> NDArray[np.float64]:
    """Return the corners (k, 3) of a convex body with few faces that encloses given corners. Each face
    touches one of the given corners.

    Args:
        corners: (m, 3) the corners to enclose.
        directions: number of directions of the faces, besides those along the axes.
    """
    from scipy.spatial import HalfspaceIntersection

    number = np.arange(directions) + 0.5
    height, turn = (
        1.0 - 2.0 * number / directions,
        number * np.pi * (1.0 + np.sqrt(5.0)),
    )  # a Fibonacci spiral, whose points are evenly distributed
    across = np.sqrt(1.0 - height**2)
    spiral = np.stack((across * np.cos(turn), across * np.sin(turn), height), axis=1)
    normals = np.concatenate((np.eye(3), -np.eye(3), spiral))
    reach = np.concatenate([(corners @ part.T).max(axis=0) for part in np.array_split(normals, 50)])
    faces = np.concatenate((normals, -(reach + _ROUNDED)[:, None]), axis=1)
    found: NDArray[np.float64] = HalfspaceIntersection(faces, corners.mean(axis=0)).intersections
    return found
