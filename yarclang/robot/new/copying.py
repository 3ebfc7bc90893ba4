"""The URDF's copy in a robot folder: the same text, with the collision meshes beside it.

What collides is needed, and what is drawn isn't: visual meshes are neither copied nor looked for. A collision mesh
that isn't there takes its <collision> out of the copy, so that what the copy says is true. One that is no mesh, or is
somebody else's file (`meshes.py`), is an error.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from urllib.parse import urlparse

from yarclang.frozen import frozen
from yarclang.robot.new.meshes import LARGEST_TOGETHER, NoMeshError, Surroundings, read_mesh
from yarclang.robot.urdf import Urdf
from yarclang.robot.urdf_shapes import mesh_path, mesh_places
from yarclang.robot.urdf_xml import Element

MESHES = "meshes"
"""The folder of the meshes beside the copy."""

_SHOWN = 80
"""Characters of a file's name in a message."""


@frozen
class UrdfCopy:
    """The copy's text, the meshes that belong to it (name in the folder, content), and what isn't as it was.

    `without` are the links that lost a collision mesh, with the mesh's name; `visuals` is the number of
    visual meshes that weren't copied.
    """

    text: str
    meshes: tuple[tuple[str, bytes], ...]
    without: tuple[tuple[str, str], ...]
    visuals: int


def copy_urdf(urdf: Urdf, file: Path, more: Iterable[Path] = ()) -> UrdfCopy:
    """Return the copy of a URDF; its findings say which files can't be copied.

    Args:
        urdf: a sound tree.
        file: where it stands.
        more: folders that meshes may come from besides.
    """
    surroundings = Surroundings(file, more)
    contents: dict[Path, bytes] = {}
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
            path = _found(name, file.parent)
            if path is None:
                without.append((link.attributes.get("name", ""), name))
                end = urdf.text.index("</collision>", body.end) + len("</collision>")
                edits.append((body.start, end, "<!-- a collision mesh was here that isn't there -->"))
                continue
            if path not in contents:
                contents[path] = _content(urdf, mesh, path, surroundings, sum(map(len, contents.values())))
                names[path] = _free(PurePosixPath(urlparse(name).path).name, set(names.values()))
            span = _filename(urdf.text, mesh)
            edits.append((*span, f'"{MESHES}/{names[path]}"'))
    text = urdf.text
    for start, stop, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[stop:]
    meshes = tuple((f"{MESHES}/{name}", contents[path]) for path, name in names.items())
    return UrdfCopy(text, meshes, tuple(without), visuals)


def _content(urdf: Urdf, mesh: Element, path: Path, surroundings: Surroundings, before: int) -> bytes:
    """Return a mesh's content; nothing, with a finding, if the file must not be copied.

    Args:
        urdf: findings go to it.
        mesh: the element that names the file.
        path: of the file.
        surroundings: the folders that it may come from.
        before: the size of the meshes before [bytes].
    """
    name = mesh.attributes.get("filename", "")
    shown = name if len(name) <= _SHOWN else f"...{name[-_SHOWN:]}"
    if not surroundings.has(name, path):
        message = f"The mesh {shown} is outside the URDF's package and isn't copied."
        remedy = f"Put it beside the URDF, or, if the file is meant, allow its folder with --meshes {shlex.quote(str(path.resolve().parent))}."
        urdf.say("Y1364", message, remedy, mesh, "filename")
        return b""
    try:
        content = read_mesh(path)
    except NoMeshError as error:
        remedy = "Name a mesh that is one, or remove the <collision>."
        urdf.say("Y1363", f"The mesh {shown} {error}.", remedy, mesh, "filename")
        return b""
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        urdf.say("Y1302", f"The mesh {shown} can't be read: {reason}.", "Check its rights.", mesh, "filename")
        return b""
    if before + len(content) > LARGEST_TOGETHER:
        message = f"With the mesh {shown}, the meshes have more than {LARGEST_TOGETHER:,} bytes together."
        urdf.say("Y1363", message, "Simplify the collision meshes.", mesh, "filename")
        return b""
    return content


def _mesh(body: Element) -> Element | None:
    geometry = body.first("geometry")
    return geometry.first("mesh") if geometry is not None else None


def _found(name: str, folder: Path) -> Path | None:
    """Return what a mesh's name means, if there is something, and no empty file."""
    try:
        path = mesh_path(name, folder)
        if path is None:
            return next((one for one in mesh_places(name, folder) if name and one.exists()), None)
        return path if path.stat().st_size > 0 else None
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
