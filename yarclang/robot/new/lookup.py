r"""Find the mesh files that a URDF names, and report those that are missing.

A name from another computer (`C:\cad\link1.stl`, `file:///home/somebody/link1.stl`, `model://arm/link1.stl`)
is looked for in the folders that the user names for meshes. The name is shortened from its start until the
rest is the path of a file in one of these folders. `arm/link1.stl` is therefore found before `link1.stl`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from urllib.parse import unquote, urlparse

from yarclang.frozen import frozen
from yarclang.robot.checklist.item import listed
from yarclang.robot.new.packages import Packages, package_of
from yarclang.robot.urdf import Urdf
from yarclang.robot.urdf_shapes import mesh_path, mesh_places
from yarclang.robot.urdf_xml import Element

_SHOWN = 80
"""Largest number of characters of a file's name in a message."""

_DEEPEST = 32
"""The largest number of parts at the end of a name (folders and the file's name) that are compared."""


@frozen
class Missing:
    """A collision mesh whose file is missing.

    Attributes:
        link: the link that needs the mesh.
        name: the mesh's name in the URDF.
        element: the XML element that names it.
    """

    link: str
    name: str
    element: Element


class Lookup:
    """A search for the files of a URDF's meshes.

    Args:
        urdf: the URDF's file.
        more: folders that the user names for meshes.
        packages: the ROS packages that `package://` may name.
    """

    def __init__(self, urdf: Path, more: Iterable[Path], packages: Packages) -> None:
        self._folder = urdf.parent
        self._more = tuple(more)
        self._packages = packages

    def path(self, name: str) -> Path | None:
        """Return the file to which a mesh's name refers, or None if the file is missing or empty."""
        try:
            named = self._packages.path(name)
            path = named if named is not None and named.is_file() else mesh_path(name, self._folder)
            path = path or self._by_end(name)
            if path is None:
                return next((one for one in mesh_places(name, self._folder) if name and one.exists()), None)
            return path if path.stat().st_size > 0 else None
        except (OSError, ValueError):
            return None

    def _by_end(self, name: str) -> Path | None:
        parts = _parts(name)
        ends = [parts[at:] for at in range(max(0, len(parts) - _DEEPEST), len(parts))]
        places = (folder.joinpath(*end) for end in ends for folder in self._more)
        return next((place for place in places if place.is_file()), None)

    def missing(self, urdf: Urdf) -> list[Missing]:
        """Return the collision meshes of a URDF whose files are missing; the URDF's links must form one
        tree.
        """
        links = urdf.root.all("link") if urdf.root else ()
        meshes = [
            (link, shape)
            for link in links
            for body in link.all("collision")
            for geometry in body.all("geometry")[:1]
            for shape in geometry.all("mesh")[:1]
        ]
        named = [
            Missing(link.attributes.get("name", ""), mesh.attributes.get("filename", ""), mesh)
            for link, mesh in meshes
        ]
        return [one for one in named if self.path(one.name) is None]

    def report(self, urdf: Urdf, missing: Sequence[Missing]) -> None:
        """Add the finding about missing collision meshes, with their names and the searched folders.

        Args:
            urdf: the URDF, which collects the finding.
            missing: the meshes, at least one.
        """
        names = {one.name: one.link for one in missing}
        each = [f"{shown_name(name)} of {shown_name(link)}" for name, link in names.items()]
        if len(each) == 1:
            message = f"The collision mesh {each[0]} isn't there."
        else:
            message = f"{len(each)} collision meshes aren't there: {listed(each, 4)}."
        urdf.say("Y1357", message, f"{self._looked(names)} {_REMEDY}", missing[0].element, "filename")

    def _looked(self, names: Iterable[str]) -> str:
        """Return sentences that tell the user in which folders mesh files were looked for."""
        sentences: dict[str, None] = {}
        below = listed([str(one) for one in self._packages.paths], 3)
        also = f" and below {below}" if below else ""
        for name in names:
            url = urlparse(name)
            if url.scheme == "package":
                folder = self._packages.folder(package_of(name))
                package = shown_name(package_of(name))
                sentences[
                    f"The package {package} is {folder}."
                    if folder is not None
                    else f"The package {package} was searched in {self._folder}, above and beside it{also}."
                ] = None
            elif url.scheme in ("http", "https"):
                sentences["Nothing is downloaded."] = None
            elif self._is_empty(name):
                sentences[f"{shown_name(name)} is empty."] = None
            elif url.scheme != "file" and not Path(name).is_absolute():
                sentences[f"Names without package:// are relative to {self._folder}."] = None
        return printable(" ".join(list(sentences)[:3]))

    def _is_empty(self, name: str) -> bool:
        try:
            path = mesh_path(name, self._folder)
            return path is not None and path.stat().st_size == 0
        except (OSError, ValueError):
            return False


_REMEDY = (
    "Give the folder of the package by --package-path FOLDER, or the folder of the meshes by --meshes "
    "FOLDER; --allow-missing-meshes makes the robot without them, and collisions of these links aren't "
    "found."
)


def shown_name(name: str) -> str:
    """Return a file's name as messages show it: printable and, if it is long, only its end."""
    plain = printable(name)
    return plain if len(plain) <= _SHOWN else f"...{plain[-_SHOWN:]}"


def printable(text: str) -> str:
    """Return a text in which a question mark replaces each unprintable character, such as a line break or a
    mark that changes the writing direction.
    """
    return "".join(one if one.isprintable() else "?" for one in text)


def _parts(name: str) -> list[str]:
    """Return the folder names and the file name in a mesh's name, without `.`, `..` and drive letters."""
    url = urlparse(name)
    path = f"{url.netloc}/{unquote(url.path)}" if len(url.scheme) > 1 else name
    return [
        part for part in path.replace("\\", "/").split("/") if part not in ("", ".", "..") and ":" not in part
    ]
