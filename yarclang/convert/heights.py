"""Convert a height field to a mesh that a cell.toml may use as an obstacle."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from yarclang.convert.cloud import MOST_TRIANGLES
from yarclang.diagnostics import Diagnostic, Result
from yarclang.files import LARGEST_MESH, read_whole, reason_of
from yarclang.frozen import frozen
from yarclang.meshes.heights import below, heights_of
from yarclang.meshes.stl import stl_of
from yarclang.meshes.voxels import TooMany
from yarclang.source import SourceFile
from yarclang.units import MM

_FAR = 1e5
"""Largest height, and largest extent, of a height field [m]. The limit for the corners of a mesh is the same.
"""


@frozen(eq=False)
class HeightMesh:
    """The mesh of a height field.

    Attributes:
        content: a binary STL file, in mm.
        size: numbers of rows and columns.
        left_out: number of heights that aren't finite.
        triangles: number of triangles.
    """

    content: bytes
    size: tuple[int, int]
    left_out: int
    triangles: int


def mesh_of_heights(path: Path, unit: float, spacing: float, every: int) -> Result[HeightMesh]:
    """Return the mesh of the body below a height field, read from a file.

    Args:
        path: an NPY or CSV file.
        unit: unit of the heights in the file [m].
        spacing: distance between neighbouring heights [m].
        every: edge length of a cell of the mesh, as a number of spacings.

    Returns:
        The mesh; None, with a finding, if the field can't be read or is too large.
    """
    try:
        content = read_whole(path, LARGEST_MESH)
    except OSError as error:
        return _refused(
            path, "Y0107", f"{path} can't be read: {reason_of(error)}", "check the path and its permissions"
        )
    found = heights_of(path.suffix, content)
    if isinstance(found, str):
        return _refused(path, "Y0962", f"the height field {path.name} {found}", _AGAIN)
    heights = found * unit
    known = np.isfinite(heights)
    if not known.any():
        return _refused(path, "Y0962", f"the height field {path.name} has no height", _AGAIN)
    far = max(float(np.abs(heights[known]).max()), max(found.shape) * spacing)
    if far > _FAR:
        message = (
            f"the height field {path.name} extends to {far:.3g} m, but at most {_FAR:,.0f} m are allowed"
        )
        return _refused(path, "Y0962", message, "check its unit (--units) and --spacing")
    made = below(heights / MM, spacing / MM, every, MOST_TRIANGLES)
    if isinstance(made, TooMany):
        message = (
            f"the height field {path.name} makes {made.triangles:,} triangles, but at most "
            f"{MOST_TRIANGLES:,} are allowed"
        )
        more = every
        while more < 2 * max(found.shape) and made.triangles * every**2 > MOST_TRIANGLES * more**2:
            more += 1
        return _refused(
            path, "Y0963", message, f"merge cells, each as high as its highest point: --every {more}"
        )
    rows, columns = found.shape
    return Result(HeightMesh(stl_of(made), (rows, columns), int((~known).sum()), len(made)), ())


_AGAIN = "save it as a table of numbers: a CSV file without a header, or numpy.save(file, heights)"


def _refused(path: Path, code: str, message: str, help_: str) -> Result[HeightMesh]:
    return Result(None, (Diagnostic(code, message, SourceFile(str(path), ""), None, help_),))
