"""Copy a URDF into a robot folder: its text, and the mesh files that it names.

Collision meshes are required. It is an error if one is missing (`lookup.py`), isn't a mesh, or isn't from the
URDF's package (`meshes.py`). If the user allows missing meshes, the <collision> elements that name them are
removed from the copy, so that the copy names only existing files. Visual meshes are optional: a mesh that
can't be copied is left out, and pictures show the collision shapes of its link.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from yarclang.files import reason_of
from yarclang.frozen import frozen
from yarclang.meshes.hull import hull_file
from yarclang.robot.new.lookup import Lookup, shown_name
from yarclang.robot.new.meshes import LARGEST_TOGETHER, NoMeshError, Surroundings, read_mesh
from yarclang.robot.new.packages import Packages
from yarclang.robot.urdf import Urdf
from yarclang.robot.urdf_xml import Element

MESHES = "meshes"
"""Name of the folder for meshes, beside the URDF's copy."""

VISUALS = f"{MESHES}/visual"
"""Name of the folder for visual meshes."""

LARGE = 5_000_000
"""Size of a collision mesh [bytes] above which only its hull is copied, since the file is read each time the
robot is read.
"""

LARGEST_VISUAL = 20_000_000
"""Largest visual mesh that is copied [bytes]. Pictures can't draw larger ones."""


@frozen
class UrdfCopy:
    """A copy of a URDF, and its differences from the original.

    Attributes:
        text: text of the copy.
        meshes: names in the robot folder and contents of the mesh files.
        without: links that lost a collision mesh, with the names of these meshes.
        unseen: names of visual meshes that weren't copied, with the reasons.
        hulls: large collision meshes that were replaced by their convex hull. The collision check of
            a new robot uses only the hulls of meshes.
    """

    text: str
    meshes: tuple[tuple[str, bytes], ...]
    without: tuple[tuple[str, str], ...]
    unseen: tuple[tuple[str, str], ...]
    hulls: tuple[str, ...] = ()


def copy_urdf(
    urdf: Urdf, file: Path, more: Iterable[Path], packages: Packages, partial: bool = False
) -> UrdfCopy:
    """Copy a URDF and its meshes. Findings name the files that can't be copied.

    Args:
        urdf: a URDF whose links form one tree.
        file: its path.
        more: additional folders that meshes may come from.
        packages: the ROS packages that `package://` may name.
        partial: True to leave out missing collision meshes; otherwise they are an error.
    """
    more = tuple(more)
    surroundings = Surroundings(file, more, packages)
    lookup = Lookup(file, more, packages)
    contents: dict[Path, bytes] = {}
    edits: list[tuple[int, int, str]] = []
    names: dict[Path, str] = {}
    without: list[tuple[str, str]] = []
    hulls: dict[Path, str] = {}
    if not partial and (missing := lookup.missing(urdf)):
        lookup.report(urdf, missing)
        return UrdfCopy(urdf.text, (), (), ())
    for link in urdf.root.all("link") if urdf.root else ():
        for body in link.all("collision"):
            mesh = _mesh(body)
            if mesh is None:
                continue
            name = mesh.attributes.get("filename", "")
            path = lookup.path(name)
            if path is None:
                without.append((link.attributes.get("name", ""), shown_name(name)))
                end = urdf.text.index("</collision>", body.end) + len("</collision>")
                edits.append((body.start, end, "<!-- a collision mesh was here that isn't there -->"))
                continue
            if path not in contents:
                content = _content(urdf, mesh, path, surroundings, sum(map(len, contents.values())))
                hull = hull_file(path.suffix, content) if len(content) > LARGE else None
                contents[path] = content if hull is None else hull
                named = path.name if hull is None else f"{path.stem}.hull.ply"
                names[path] = _free(named, set(names.values()))
                if hull is not None:
                    hulls[path] = f"{shown_name(path.name)} of {len(content) / 1e6:.0f} MB"
            span = _filename(urdf.text, mesh)
            edits.append((*span, f'"{MESHES}/{names[path]}"'))
    whole = {path: name for path, name in names.items() if path not in hulls}
    drawn, unseen = _copy_visuals(urdf, lookup, surroundings, (contents, whole), edits)
    text = urdf.text
    for start, stop, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[stop:]
    meshes = tuple((f"{MESHES}/{name}", contents[path]) for path, name in names.items())
    return UrdfCopy(text, (*meshes, *drawn), tuple(without), unseen, tuple(hulls.values()))


def _copy_visuals(
    urdf: Urdf,
    lookup: Lookup,
    surroundings: Surroundings,
    collisions: tuple[dict[Path, bytes], dict[Path, str]],
    edits: list[tuple[int, int, str]],
) -> tuple[tuple[tuple[str, bytes], ...], tuple[tuple[str, str], ...]]:
    """Copy the visual meshes that can be copied.

    Args:
        urdf: a URDF whose links form one tree.
        lookup: object that finds the files.
        surroundings: the folders that meshes may come from.
        collisions: contents and names of the collision meshes, by their paths. A visual mesh whose file is
            among them isn't copied again.
        edits: start, end and new text of each change of the copy. Changes are added to it.

    Returns:
        The meshes (name in the robot folder, content), and those that weren't copied, each with the reason.
    """
    contents, given = collisions
    names = {path: f"{MESHES}/{name}" for path, name in given.items() if contents[path]}
    drawn: dict[str, bytes] = {}
    unseen: dict[str, str] = {}
    size = sum(map(len, contents.values()))
    bodies = [body for link in (urdf.root.all("link") if urdf.root else ()) for body in link.all("visual")]
    for mesh in filter(None, map(_mesh, bodies)):
        name = mesh.attributes.get("filename", "")
        path = lookup.path(name)
        if path is None:
            unseen[shown_name(name)] = "isn't there"
            continue
        if path not in names:
            content = _visual(name, path, surroundings)
            if isinstance(content, str) or size + len(content) > LARGEST_TOGETHER:
                unseen[shown_name(name)] = (
                    content if isinstance(content, str) else "makes the meshes too large together"
                )
                continue
            free = _free(path.name, {PurePosixPath(one).name for one in drawn})
            names[path] = f"{VISUALS}/{free}"
            drawn[names[path]] = content
            size += len(content)
        edits.append((*_filename(urdf.text, mesh), f'"{names[path]}"'))
    return tuple(drawn.items()), tuple(unseen.items())


def _visual(name: str, path: Path, surroundings: Surroundings) -> bytes | str:
    """Return the content of a visual mesh, or the reason why it isn't copied."""
    if not surroundings.has(name, path):
        return "is outside the URDF's package"
    try:
        if path.stat().st_size > LARGEST_VISUAL:
            return f"has more than {LARGEST_VISUAL:,} bytes"
        return read_mesh(path)
    except NoMeshError as error:
        return str(error)
    except OSError as error:
        return f"can't be read: {reason_of(error)}"


def _content(urdf: Urdf, mesh: Element, path: Path, surroundings: Surroundings, before: int) -> bytes:
    """Return a mesh's content. If the file must not be copied, report a finding and return an empty content.

    Args:
        urdf: the URDF, which collects findings.
        mesh: the element that names the file.
        path: the file.
        surroundings: the folders that it may come from.
        before: total size of the meshes copied so far [bytes].
    """
    name = mesh.attributes.get("filename", "")
    mesh_name = shown_name(name)
    if not surroundings.has(name, path):
        message = f"The mesh {mesh_name} is outside the URDF's package and isn't copied."
        remedy = (
            "Put it beside the URDF, or, if this file is intended, allow its folder with --meshes "
            f"{shlex.quote(str(path.resolve().parent))}."
        )
        urdf.say("Y1364", message, remedy, mesh, "filename")
        return b""
    try:
        content = read_mesh(path)
    except NoMeshError as error:
        remedy = "Name a mesh file, or remove the <collision>."
        urdf.say("Y1363", f"The mesh {mesh_name} {error}.", remedy, mesh, "filename")
        return b""
    except OSError as error:
        reason = reason_of(error)
        urdf.say(
            "Y1302",
            f"The mesh {mesh_name} can't be read: {reason}.",
            "Check its permissions.",
            mesh,
            "filename",
        )
        return b""
    if before + len(content) > LARGEST_TOGETHER:
        message = f"With the mesh {mesh_name}, the meshes have more than {LARGEST_TOGETHER:,} bytes together."
        urdf.say("Y1363", message, "Simplify the collision meshes.", mesh, "filename")
        return b""
    return content


def _mesh(body: Element) -> Element | None:
    geometry = body.first("geometry")
    return geometry.first("mesh") if geometry is not None else None


def _free(name: str, names: set[str]) -> str:
    """Return a file name without unusual characters that isn't among `names`."""
    stem, suffix = PurePosixPath(name).stem, PurePosixPath(name).suffix
    stem, suffix = re.sub(r"[^A-Za-z0-9_.-]", "_", stem), re.sub(r"[^A-Za-z0-9_.-]", "_", suffix)
    free, number = f"{stem}{suffix}", 2
    while free.lower() in {one.lower() for one in names}:
        free, number = f"{stem}_{number}{suffix}", number + 1
    return free


def _filename(text: str, mesh: Element) -> tuple[int, int]:
    """Return the start and the end of the value of a <mesh> element's filename attribute in the text, with
    its quotes.
    """
    match = re.compile(r"""\sfilename\s*=\s*("[^"]*"|'[^']*')""").search(text, mesh.start, mesh.end)
    assert match is not None  # the element was read from this text
    return match.span(1)
