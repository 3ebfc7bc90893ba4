"""Check for files that describe the robot or its cell. Such files are guarded: only service users who have
entered their PIN may change them.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path

from yarclang.pendant.project.names import folded
from yarclang.pendant.project.places import Places
from yarclang.pendant.project.tree import Walk
from yarclang.pipeline.project import find_project
from yarclang.runtime.actions import Trouble
from yarclang.toml.bodies import MESHES

_DESCRIBES = (".toml", ".urdf", ".xacro", ".srdf", *MESHES)
_SCRIPT = ".inputs.toml"
"""Ending of the names of scripts that set the inputs of a simulated robot. These files aren't guarded."""
_MOST_SEEN = 20_000
"""Largest number of names that are read of a folder. A folder with more names counts as guarded."""


def describes(name: str) -> bool:
    """Return True if a file of this name describes a robot or a cell."""
    plain = folded(name)
    return plain.endswith(_DESCRIBES) and not plain.endswith(_SCRIPT)


class Guarded:
    """Check for guarded paths: paths that lead to files that describe the robot or the cell, possibly through
    links or under other names. The functions wait for the disk.

    Args:
        places: access to the files of the project.
        folders: folders that describe robots. All files in them are guarded; the project's own folder is
            ignored here.
    """

    def __init__(self, places: Places, folders: Iterable[Path] = ()) -> None:
        self._places = places
        self._folders = tuple(one.resolve() for one in folders)

    def objection(self, *names: str) -> str:
        """Return the reason why one of the paths is guarded; empty if none of them is.

        Args:
            *names: paths of files, links or folders, relative to the project's folder. They need not exist.
        """
        look = _Look(self._places, self._folders)
        return next((reason for name in names if (reason := look.reason(name))), "")

    def objection_to_kept(self, content: Path, name: str) -> str:
        """Return the reason why only service users may restore a file or folder from the trash. Empty: other
        users may, too.

        Args:
            content: path of the file or folder in the trash.
            name: path in the project to which the file or folder would be restored.
        """
        look = _Look(self._places, self._folders)
        if reason := look.reason(name):
            return reason
        inside = look.inside(content) if content.is_dir() and not content.is_symlink() else ""
        return _holds(name, inside) if inside else ""


class _Look:
    """Check of paths for one request. Two searches are made only once for a request: for the files that
    yarc.toml names, and for files with several names (hard links).
    """

    def __init__(self, places: Places, folders: tuple[Path, ...]) -> None:
        self._places = places
        project = find_project(places.root).value
        named = [] if project is None else [project.cell, project.robot]
        found = [] if project is None else [(project.folder / one).resolve() for one in named if one]
        self._cells = tuple(one for one in found if not one.is_dir())
        robots = (*folders, *(one for one in found if one.is_dir()))
        self._robots = tuple(one for one in robots if one != places.root and one.is_relative_to(places.root))

    def reason(self, name: str) -> str:
        reasons: dict[tuple[str, ...], None] = {}
        for link in (True, False):  # the link itself, and its target
            try:
                reasons[self._places.resolved(name, link=link)] = None
            except (Trouble, OSError, ValueError, RuntimeError):
                continue  # the reason is reported when the file is opened
        for parts in reasons:
            path = self._places.root.joinpath(*parts)
            if self._is_guarded(path):
                return f"{name[:80]} describes the robot or its cell"
            if path.is_dir() and not path.is_symlink() and (inside := self.inside(path)):
                return _holds(name, inside)
        return ""

    def inside(self, folder: Path) -> str:
        """Return a guarded file in a folder or its subfolders; empty if there is none."""
        for one in self._robots:
            if one.is_relative_to(folder):
                return one.name
        count = 0
        for top, folders, files in os.walk(folder):
            for name in (*folders, *files):
                if self._is_guarded(Path(top) / name):
                    return name
                count += 1
                if count > _MOST_SEEN:
                    return "more files than are looked at"
        return ""

    def _is_guarded(self, path: Path) -> bool:
        if describes(path.name) or path in self._cells:
            return True
        if any(path == robot or path.is_relative_to(robot) for robot in self._robots):
            return True
        try:
            told = path.lstat()
        except (OSError, ValueError):
            return False
        return told.st_nlink > 1 and not path.is_dir() and (told.st_dev, told.st_ino) in self._identities

    @cached_property
    def _identities(self) -> frozenset[tuple[int, int]]:
        """Device and inode numbers of all guarded files. They identify a guarded file that has further
        names (hard links).
        """
        identities = set()
        named = [self._places.root / one.file for one in Walk(self._places, _DESCRIBES).entries()]
        for robot in self._robots:
            named += [Path(top) / name for top, _, files in os.walk(robot) for name in files]
        for path in (*self._cells, *named):
            try:
                told = path.stat()
            except OSError:
                continue
            identities.add((told.st_dev, told.st_ino))
        return frozenset(identities)


def _holds(name: str, inside: str) -> str:
    return f"{name[:80]} holds {inside[:80]}, which describes the robot or its cell"
