"""The convex hull of a large mesh as a small file."""

from __future__ import annotations

import numpy as np

from yarclang.meshes.obj import obj_corners
from yarclang.meshes.stl import stl_corners

_FLAT = 1e-6
"""Thinner than this share of its size, a mesh has no hull."""

_MOST = 50_000
"""A hull with more corners isn't worth a file of its own."""

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
    """Return a PLY file of the convex hull of a mesh, with its corners to the last bit; None for a flat mesh, and for a format or text that isn't read as arrays.

    Args:
        suffix: of the mesh's name, in any case, with its dot.
        content: of its file.
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
    if len(hull.vertices) > _MOST:
        return None
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
