"""Convert a point cloud to a mesh that a cell.toml may use as an obstacle."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from yarclang.diagnostics import Diagnostic, Result
from yarclang.files import LARGEST_MESH, read_whole, reason_of
from yarclang.frozen import frozen
from yarclang.meshes.pcd import pcd_points
from yarclang.meshes.ply import ply_points
from yarclang.meshes.stl import stl_of
from yarclang.meshes.voxels import TooMany, voxels_of
from yarclang.source import SourceFile
from yarclang.units import MM

CLOUDS = (".pcd", ".ply")
"""Suffixes of point clouds."""

MOST_TRIANGLES = 2_000_000
"""Largest number of triangles of the mesh. A larger mesh is refused, since larger cubes are good enough for
an obstacle of this size.
"""

_FAR = 1e5
"""Largest distance of a point from the cloud's origin [m]. The limit for the corners of a mesh is the same.
"""


@frozen(eq=False)
class CloudMesh:
    """The mesh of a point cloud: the outer faces of cubes.

    Attributes:
        content: a binary STL file, in mm.
        points: number of points.
        left_out: number of points that were left out because they aren't finite.
        cubes: number of cubes.
        triangles: number of triangles.
    """

    content: bytes
    points: int
    left_out: int
    cubes: int
    triangles: int


def mesh_of_cloud(path: Path, unit: float, voxel: float) -> Result[CloudMesh]:
    """Return the mesh of all cubes of a grid that contain points of a cloud.

    Args:
        path: a PCD or PLY file.
        unit: unit of the numbers in the file [m].
        voxel: edge of a cube [m].

    Returns:
        The mesh; None, with a finding, if the cloud can't be read or is too large.
    """
    try:
        content = read_whole(path, LARGEST_MESH)
    except OSError as error:
        return _refused(
            path, "Y0107", f"{path} can't be read: {reason_of(error)}", "check the path and its permissions"
        )
    found = (pcd_points if path.suffix.lower() == ".pcd" else ply_points)(content)
    if isinstance(found, str):
        return _refused(path, "Y1516", f"the point cloud {path.name} {found}", _AGAIN)
    points = found[np.isfinite(found).all(axis=1)] * unit
    if not len(points):
        return _refused(path, "Y1516", f"the point cloud {path.name} has no point", _AGAIN)
    far = float(np.abs(points).max())
    if far > _FAR:
        message = (
            f"the point cloud {path.name} has a point {far:.3g} m from its origin, but at most {_FAR:,.0f} "
            "m are allowed"
        )
        return _refused(path, "Y1516", message, "check its unit (--units)")
    made = voxels_of(points, voxel, MOST_TRIANGLES)
    if isinstance(made, TooMany):
        many = f": they make {made.triangles:,} triangles, but at most {MOST_TRIANGLES:,} are allowed"
        message = f"cubes of {voxel / MM:g} mm are too small for {path.name}{many if made.triangles else ''}"
        return _refused(path, "Y1517", message, "use larger cubes (--voxel)")
    stl = stl_of(made.triangles / MM)
    return Result(CloudMesh(stl, len(points), len(found) - len(points), made.cubes, len(made.triangles)), ())


_AGAIN = "save it again as PCD or PLY, with the points in their own frame"


def _refused(path: Path, code: str, message: str, help_: str) -> Result[CloudMesh]:
    return Result(None, (Diagnostic(code, message, SourceFile(str(path), ""), None, help_),))
