"""The URDF's copy in a robot folder: the same text, with the collision meshes beside it.

What collides is needed, and what is drawn isn't: visual meshes are neither copied nor looked for. A collision mesh
that isn't there takes its <collision> out of the copy, so that what the copy says is true.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from urllib.parse import urlparse

from yarclang.robot.urdf import Urdf
from yarclang.robot.urdf_shapes import mesh_path
from yarclang.robot.urdf_xml import Element

MESHES = "meshes"
"""The folder of the meshes beside the copy."""


@dataclass(frozen=True, slots=True)
class UrdfCopy:
    """The copy's text, the meshes that belong to it (name in the folder, file), and what isn't as it was.

    `without` are the links that lost a collision mesh, with the mesh's name; `visuals` is the number of
    visual meshes that weren't copied.
    """

    text: str
    meshes: tuple[tuple[str, Path], ...]
    without: tuple[tuple[str, str], ...]
    visuals: int


def copy_urdf(urdf: Urdf, folder: Path) -> UrdfCopy:
    """The copy of a URDF that stands in `folder`."""
    edits: list[tuple[int, int, str]] = []
    names: dict[Path, str] = {}
    without: list[tuple[str, str]] = []
    visuals = 0
    for link in urdf.root.all("link") if urdf.root else ():
        visuals += sum(_mesh(body) is not None for body in link.all("visual"))
        for body in link.all("collision"):
            mesh = _mesh(body)
            if mesh is None:
                continue
            name = mesh.attributes.get("filename", "")
            path = _found(name, folder)
            if path is None:
                without.append((link.attributes.get("name", ""), name))
                end = urdf.text.index("</collision>", body.end) + len("</collision>")
                edits.append((body.start, end, "<!-- a collision mesh was here that isn't there -->"))
                continue
            if path not in names:
                names[path] = _free(PurePosixPath(urlparse(name).path).name, set(names.values()))
            span = _filename(urdf.text, mesh)
            edits.append((*span, f'"{MESHES}/{names[path]}"'))
    text = urdf.text
    for start, stop, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[stop:]
    meshes = tuple((f"{MESHES}/{name}", path) for path, name in names.items())
    return UrdfCopy(text, meshes, tuple(without), visuals)


def _mesh(body: Element) -> Element | None:
    geometry = body.first("geometry")
    return geometry.first("mesh") if geometry is not None else None


def _found(name: str, folder: Path) -> Path | None:
    """The file of a mesh if it can be read and isn't empty."""
    try:
        path = mesh_path(name, folder)
        return path if path is not None and path.stat().st_size > 0 else None
    except (OSError, ValueError):
        return None


def _free(name: str, taken: set[str]) -> str:
    """A plain file name that isn't taken."""
    stem, suffix = PurePosixPath(name).stem, PurePosixPath(name).suffix
    stem, suffix = re.sub(r"[^A-Za-z0-9_.-]", "_", stem), re.sub(r"[^A-Za-z0-9_.-]", "_", suffix)
    free, number = f"{stem}{suffix}", 2
    while free.lower() in {one.lower() for one in taken}:
        free, number = f"{stem}_{number}{suffix}", number + 1
    return free


def _filename(text: str, mesh: Element) -> tuple[int, int]:
    """Where the value of a mesh's filename stands, with its quotes."""
    match = re.compile(r"""\sfilename\s*=\s*("[^"]*"|'[^']*')""").search(text, mesh.start, mesh.end)
    assert match is not None  # the element was read from this text
    return match.span(1)
