"""Decide which files may be copied into a robot folder as meshes: only meshes from the URDF's own package,
and from folders that the user names.

A URDF from elsewhere may name any file of this computer, and the robot folder that is created from it may be
given away. A file therefore counts as a mesh only if its whole content has the form of a mesh. The bytes that
were checked are the bytes that are copied.
"""

from __future__ import annotations

import io
import os
import re
import stat
from collections.abc import Callable, Iterable
from pathlib import Path
from urllib.parse import urlparse
from xml.parsers import expat

from yarclang.meshes.faults import mesh_fault
from yarclang.meshes.stl import is_binary
from yarclang.robot.new.packages import PACKAGE, Packages, package_of
from yarclang.toml.bodies import MESHES

_ORDINARY = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)
"""Flags for opening an ordinary file. Two of these flags don't exist on all systems."""
LARGEST = 100_000_000
"""Largest mesh file [bytes]."""

LARGEST_TOGETHER = 500_000_000
"""Largest sum of all mesh files of a robot [bytes]."""

_BESIDE = {"urdf", "urdfs", "robot", "robots", "xacro", "model", "models"}
"""Names of folders for URDFs whose meshes are in another folder beside the URDF's folder."""

_NUMBER = rb"[-+0-9.#a-z()]+"
_SPACE = rb"[ \t\r\f\v]"
_NO_STL_LINE = re.compile(
    rb"^(?!%(s)s*(?:solid\b.*|facet%(s)s+normal(?:%(s)s+%(n)s){3}|outer%(s)s+loop|vertex(?:%(s)s+%(n)s){3}|endloop|endfacet|endsolid\b.*)?%(s)s*$)"
    % {b"n": _NUMBER, b"s": _SPACE},
    re.IGNORECASE | re.MULTILINE,
)
_OBJ_WORDS = set(
    b"v vt vn vp f fo l p o g s mg usemtl mtllib usemap maplib bevel c_interp d_interp lod shadow_obj "
    b"trace_obj deg cstype curv curv2 "
    b"surf parm trim hole scrv sp end con ctech stech bmat step".split()
)
_LONGEST_HEADER = 100_000
_LFS = b"version https://git-lfs.github.com/spec/"
_PLY_HEADER = re.compile(
    rb"ply\r?\nformat (?P<form>ascii|binary_little_endian|binary_big_endian) 1\.0\s*?\n"
    rb"(?:(?:comment|obj_info|element|property)\b[^\n]*\n)*?end_header\r?\n"
)
_NO_NUMBER = re.compile(rb"[^-+0-9.einfa\s]", re.IGNORECASE)


class NoMeshError(Exception):
    """Raised if a file can't be copied as a mesh. The message is the end of a sentence that begins with the
    file's name.
    """


def read_mesh(path: Path) -> bytes:
    """Return the content of a mesh file.

    Raises:
        NoMeshError: the file isn't a mesh, isn't an ordinary file, or is too large.
        OSError: the file can't be read.
    """
    kind = path.suffix.lower()
    if kind not in MESHES:
        raise NoMeshError(f"doesn't end in {', '.join(MESHES[:-1])} or {MESHES[-1]}")
    if not path.is_file():  # opening a pipe would wait for a writer, and opening some devices has effects
        raise NoMeshError("isn't a regular file")
    handle = os.open(path, _ORDINARY)
    with os.fdopen(handle, "rb") as file:
        found = os.fstat(handle)
        if not stat.S_ISREG(found.st_mode):
            raise NoMeshError("isn't a regular file")
        if found.st_size > LARGEST:
            raise NoMeshError(f"has {found.st_size:,} bytes, more than {LARGEST:,}")
        content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise NoMeshError(f"has more than {LARGEST:,} bytes")
    if not _LOOKS[kind](content):
        raise NoMeshError(
            f"ends in {path.suffix}, but its content has another format{_damage(kind, content)}"
        )
    if fault := mesh_fault(kind, content):
        raise NoMeshError(fault)
    return content


def _damage(kind: str, content: bytes) -> str:
    """Return the end of a sentence that says how a mesh file is damaged; empty if its content shows no
    damage.
    """
    if not content:
        return ": it is empty"
    if content.startswith(_LFS):
        return ": a pointer of Git LFS, which 'git lfs pull' replaces by the file"
    if kind == ".stl" and len(content) >= 84 and not content.startswith(b"solid"):
        count = int.from_bytes(content[80:84], "little")
        return (
            f" (a binary STL of {count:,} triangles has {84 + 50 * count:,} bytes, this one has "
            f"{len(content):,})"
        )
    if kind == ".dae" and b"<COLLADA" in content[:_LONGEST_HEADER]:
        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = _refuse
        try:
            parser.Parse(content, True)
        except ValueError:
            return " (XML with a DOCTYPE)"
        except expat.ExpatError as error:
            return f" (XML, line {error.lineno}: {expat.ErrorString(error.code)})"
    return ""


class Surroundings:
    """The folders that a URDF's meshes may come from.

    These are the URDF's folder, the ROS package of the URDF, ROS packages that `package://` names, and
    folders that the user names. If the URDF's folder is called urdf or similar, the folder above it counts as
    well.

    Args:
        urdf: the URDF's file. If it is a symbolic link, the package of its target counts as well.
        more: folders that the user names.
        packages: ROS packages by the names in their package.xml.
    """

    def __init__(self, urdf: Path, more: Iterable[Path] = (), packages: Packages | None = None) -> None:
        self.packages = packages
        self._roots = {one.resolve() for one in more}
        for here in {urdf.absolute().parent, urdf.resolve().parent}:
            package = next((above for above in (here, *here.parents) if (above / PACKAGE).is_file()), None)
            beside = here.parent if here.name.lower() in _BESIDE else here
            self._roots |= {(package or beside).resolve(), here.resolve()}

    def has(self, name: str, path: Path) -> bool:
        """Return True if a mesh file is in one of these folders after symbolic links are resolved.

        Args:
            name: the mesh's name in the URDF.
            path: the file to which the name refers.
        """
        resolved = path.resolve()
        if any(resolved.is_relative_to(root) for root in self._roots):
            return True
        package = _package(name, path)
        if self.packages is not None and self.packages.path(name) == path:
            package = self.packages.folder(package_of(name))
            package = package.resolve() if package is not None else None
        return package is not None and resolved.is_relative_to(package)


def _package(name: str, path: Path) -> Path | None:
    """Return the folder of the ROS package with which a mesh's name begins, or None."""
    package, url = package_of(name), urlparse(name)
    inside = Path(url.path.lstrip("/")).parts[0 if url.netloc else 1 :]
    if not inside or not package or ".." in (package, *inside):
        return None
    folder = path.absolute().parents[len(inside) - 1]
    return folder.resolve() if (folder / PACKAGE).is_file() else None


def _is_stl(content: bytes) -> bool:
    """Return True for a binary STL (80 bytes, the number of triangles, 50 bytes for each) and for a text
    STL.
    """
    if is_binary(content):
        return True
    return content.startswith((b"solid ", b"solid\n", b"solid\r")) and _NO_STL_LINE.search(content) is None


def _is_obj(content: bytes) -> bool:
    """Return True if all lines begin with a word of the OBJ format, and there are points and faces."""
    words: set[bytes] = set()
    continued = False
    for line in io.BytesIO(content):
        first = line.split(maxsplit=1)[:1]
        if first and not continued and not first[0].startswith(b"#"):
            words.add(first[0])
            if first[0] not in _OBJ_WORDS:
                return False
        continued = line.rstrip(b"\r\n").endswith(b"\\")
    return {b"v", b"f"} <= words


def _refuse(*_: object) -> None:
    raise ValueError("a DOCTYPE")


def _is_dae(content: bytes) -> bool:
    """Return True for XML without a DOCTYPE whose root is COLLADA and contains a mesh."""
    tags: set[str] = set()
    roots: list[str] = []

    def begin(tag: str, _: dict[str, str]) -> None:
        if not roots:
            roots.append(tag.rpartition(" ")[2])
        tags.add(tag.rpartition(" ")[2])

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = begin
    parser.StartDoctypeDeclHandler = _refuse
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError):
        return False
    return roots == ["COLLADA"] and {"geometry", "mesh"} <= tags


def _is_ply(content: bytes) -> bool:
    """Return True for a PLY header, followed only by numbers if the header declares ascii."""
    header = _PLY_HEADER.match(content, 0, _LONGEST_HEADER)
    if header is None or b"\nelement vertex " not in header[0]:
        return False
    return header["form"] != b"ascii" or _NO_NUMBER.search(content, header.end()) is None


_LOOKS: dict[str, Callable[[bytes], bool]] = {
    ".stl": _is_stl,
    ".obj": _is_obj,
    ".dae": _is_dae,
    ".ply": _is_ply,
}
