"""Find ROS packages: the folders to which `package://` names refer."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath
from urllib.parse import unquote, urlparse

PACKAGE = "package.xml"
"""The file that makes a folder a ROS package."""

MOST_FOLDERS = 20_000
"""The largest number of folders that are searched for packages."""

_NAME = re.compile(rb"<name>\s*([A-Za-z0-9_\-]+)\s*</name>")
_LONGEST = 100_000


class Packages:
    """The packages around a URDF and below given folders, by the names in their package.xml.

    Args:
        urdf: the URDF's file. The package that contains it, and the folders beside this package, are
            searched.
        paths: folders with packages, in the order of preference.
    """

    def __init__(self, urdf: Path, paths: Iterable[Path] = ()) -> None:
        self.paths = tuple(paths)
        self._urdf = urdf.absolute()
        self._found: dict[str, Path] | None = None

    def folder(self, name: str) -> Path | None:
        """Return the folder of a package, or None."""
        if self._found is None:
            self._found = {}
            for folder in (*self._near(), *(one for path in self.paths for one in _below(path))):
                if (found := package_name(folder)) is not None:
                    self._found.setdefault(found, folder)
        return self._found.get(name)

    def path(self, filename: str) -> Path | None:
        """Return the file to which a `package://` name refers by package.xml, or None if there is no such
        file.
        """
        name = package_of(filename)
        inside = PurePosixPath(unquote(urlparse(filename).path).lstrip("/"))
        if not urlparse(filename).netloc:
            inside = PurePosixPath(*inside.parts[1:])
        if not name or ".." in inside.parts:
            return None
        folder = self.folder(name)
        return folder / inside if folder is not None else None

    def _near(self) -> Iterator[Path]:
        for above in self._urdf.parents:
            if (above / PACKAGE).is_file():
                yield above
                with contextlib.suppress(OSError):
                    yield from sorted(one for one in above.parent.iterdir() if one.is_dir())
                return


def package_of(filename: str) -> str:
    """Return the package that a mesh's `package://` name begins with, also if it is written with three
    slashes; empty for other names.
    """
    url = urlparse(filename)
    if url.scheme != "package":
        return ""
    return url.netloc or unquote(url.path).lstrip("/").partition("/")[0]


def package_name(folder: Path) -> str | None:
    """Return the name in a folder's package.xml, or None."""
    file = folder / PACKAGE
    try:
        if not file.is_file():
            return None
        with file.open("rb") as stream:
            match = _NAME.search(stream.read(_LONGEST))
    except OSError:
        return None
    return match[1].decode() if match else None


def _below(top: Path) -> Iterator[Path]:
    """Yield all packages below a folder. Packages inside other packages are left out, and the search ends
    after `MOST_FOLDERS` folders.
    """
    for count, (folder, folders, files) in enumerate(os.walk(top)):
        if count >= MOST_FOLDERS:
            return
        if PACKAGE in files:
            folders.clear()
            yield Path(folder)
        folders[:] = sorted(one for one in folders if not one.startswith("."))
