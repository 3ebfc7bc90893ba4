"""Binary meshes for browsers: corners, triangles, and normals. Normals aren't smoothed across sharp edges.
The id of a mesh is a hash of its content.
"""

from __future__ import annotations

import gzip
import hashlib
from dataclasses import dataclass

import numpy as np

from yarclang.report.solids import Solid
from yarclang.robot.model import Array
from yarclang.view.stage import Rows

_EDGE = np.cos(np.deg2rad(35.0))
"""Cosine of 35 deg. The edge between two faces is drawn sharp if the angle between their normals is larger
than this angle.
"""
_MOST_AROUND = 64
"""Largest number of faces around one corner that are compared when normals are averaged."""
_LARGE = 4096
"""Size above which a mesh is also stored in compressed form [bytes]."""


@dataclass(frozen=True, slots=True)
class Blob:
    """A mesh in its binary format.

    The format, little endian: number V of corners and number F of triangles (uint32), V corners x y z
    (float32) [m], F triangles (3 x uint32), V normals x y z (int8, scaled by 127).

    Attributes:
        id: hash of the content.
        content: the mesh in this format.
        packed: the content compressed with gzip; empty for a small mesh.
    """

    id: str
    content: bytes
    packed: bytes


def blob_of(solid: Solid) -> Blob:
    """Return the mesh of a body. The mesh's id is a hash of its content, so that a browser's cache never
    shows another body.
    """
    vertices, normals, faces = creased(solid)
    content = b"".join(
        (
            np.array([len(vertices), len(faces)], dtype="<u4").tobytes(),
            vertices.astype("<f4").tobytes(),
            faces.astype("<u4").tobytes(),
            np.round(127.0 * normals).astype(np.int8).tobytes(),
        )
    )
    packed = gzip.compress(content, 6, mtime=0) if len(content) >= _LARGE else b""
    return Blob(hashlib.sha256(content).hexdigest()[:24], content, packed)


def creased(solid: Solid) -> tuple[Array, Array, Rows]:
    """Compute the normals with which a body is drawn, one for each corner of each face. A normal is the mean
    of the normals of the faces around the corner. Faces that are bent against the corner's own face by more
    than 35 deg (`_EDGE`) are left out of the mean.

    Returns:
        Three arrays: corners (V, 3), the normals of these corners (V, 3), and the indices of each face's
        corners (F, 3). A corner is repeated for each of its normals.
    """
    faces = solid.faces
    corners = solid.vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1, keepdims=True)
    flat = across / np.maximum(area, 1e-300)
    # Merge corners at the same place: in many files, every face has its own corners.
    size = float(np.abs(solid.vertices).max(initial=1e-9))
    _, place = np.unique(_packed(np.round(solid.vertices / (size * 1e-6)), 21), return_inverse=True)
    at = place.reshape(-1)[faces].ravel()
    own = np.repeat(np.arange(len(faces)), 3)
    normals = _means(at, own, flat, across)
    key = at * (1 << 24) + _packed(np.round(127.0 * normals), 8)
    _, first, back = np.unique(key, return_index=True, return_inverse=True)
    return solid.vertices[faces.ravel()[first]], normals[first], back.reshape(-1, 3)


def _means(at: Rows, face_of_corner: Rows, flat: Array, across: Array) -> Array:
    """Return the mean normals of the corners of F faces, weighted by the faces' areas, as (3 F, 3).

    Args:
        at: (3 F,) number of the place of each corner; corners of several faces at the same place have the
            same number.
        face_of_corner: (3 F,) number of the face to which each corner belongs.
        flat: (F, 3) unit normals of the faces.
        across: (F, 3) normals of the faces with twice the faces' areas as lengths.
    """
    order = np.argsort(at, kind="stable")
    _, begins, counts = np.unique(at[order], return_index=True, return_counts=True)
    summed = np.zeros((len(at), 3))
    rank = np.arange(len(at)) - np.repeat(begins, counts)
    count, begin = np.repeat(counts, counts), np.repeat(begins, counts)
    mine = face_of_corner[order]
    rows = np.arange(len(at))
    # The corners are sorted by place, so that corners at one place form a group. In round `step`, each corner
    # is compared with the corner of its group that follows `step` positions later (cyclically).
    for step in range(min(int(counts.max(initial=0)), _MOST_AROUND)):
        rows = rows[count[rows] > step]
        here, other = mine[rows], mine[begin[rows] + (rank[rows] + step) % count[rows]]
        alike = np.einsum("ij,ij->i", flat[here], flat[other]) >= _EDGE
        summed[order[rows[alike]]] += across[other[alike]]
    length = np.linalg.norm(summed, axis=1, keepdims=True)
    return np.where(length > 0.0, summed / np.maximum(length, 1e-300), flat[face_of_corner])


def _packed(values: Array, bits: int) -> Rows:
    """Pack three signed integers of `bits` bits each (N, 3) into one integer (N,)."""
    whole = values.astype(np.int64) + (1 << (bits - 1))
    found: Rows = (whole[:, 0] << (2 * bits)) | (whole[:, 1] << bits) | whole[:, 2]
    return found
