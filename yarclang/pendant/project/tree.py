"""Listing of the project's folder in limited time: names, sizes and times."""

from __future__ import annotations

import os
import stat
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime

from yarclang.pendant.project.places import Places
from yarclang.runtime.actions import Trouble

MOST_SEEN = 300_000
"""Largest number of names that are read, counting a folder and all of its subfolders."""

MOST_IN_FOLDER = 20_000
"""Largest number of names of one folder that are listed. Sorting more names would take too long."""

_BREATH = 100
"""Number of names after which the listing thread pauses briefly, so that it doesn't block the loop that
streams to the controller.
"""

DEEPEST = 60
"""Deepest nesting of folders."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A file or folder of the project.

    Attributes:
        file: path in the project.
        size: size [bytes].
        changed: time of the last change (UTC).
        is_folder: True for a folder.
    """

    file: str
    size: int
    changed: str
    is_folder: bool


@dataclass(slots=True)
class Walk:
    """A walk through the project's folder and its subfolders.

    Attributes:
        places: access to the files of the project.
        suffixes: suffixes of the wanted files, in lower case; empty for all files and folders.
        cut: True if files were left out because a limit on their number or depth was reached.
    """

    places: Places
    suffixes: tuple[str, ...] = ()
    cut: bool = False
    _left: int = MOST_SEEN
    _seen: set[tuple[int, int]] = field(default_factory=set)
    _private: frozenset[tuple[int, int]] = frozenset()

    def entries(self) -> Iterator[Entry]:
        """Yield files and folders, in each folder sorted by name. Hidden and private files, pipes, devices
        and links that lead out of the project are left out.
        """
        self._private = self.places.private_now()
        with self.places.top() as top:
            yield from self._inside(top, "", 0)

    def _inside(self, folder: int, path: str, depth: int) -> Iterator[Entry]:
        told = os.fstat(folder)
        if (told.st_dev, told.st_ino) in self._seen:  # the folder is mounted twice
            return
        self._seen.add((told.st_dev, told.st_ino))
        for count, name in enumerate(self._names(folder)):
            if count % _BREATH == _BREATH - 1:
                time.sleep(0.0005)
            with suppress(OSError):  # skip files that have just been removed
                entry, is_folder = self._entry(folder, name, path)
                if entry is not None:
                    yield entry
                if is_folder:
                    yield from self._deeper(folder, name, path, depth)

    def _deeper(self, folder: int, name: str, path: str, depth: int) -> Iterator[Entry]:
        if depth >= DEEPEST:
            self.cut = True
            return
        inner = os.open(name, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC, dir_fd=folder)
        try:
            yield from self._inside(inner, f"{path}{name}/", depth + 1)
        finally:
            os.close(inner)

    def _names(self, folder: int) -> list[str]:
        entries = []
        with suppress(OSError), os.scandir(folder) as listed:
            for entry in listed:
                if self._left <= 0:
                    self.cut = True
                    break
                self._left -= 1
                if self._left % _BREATH == 0:
                    time.sleep(0.0005)
                if self._is_wanted(entry):
                    entries.append(entry.name)
                    if len(entries) >= MOST_IN_FOLDER:
                        self.cut = True
                        break
        return sorted(entries)

    def _is_wanted(self, entry: os.DirEntry[str]) -> bool:
        if entry.name.startswith(".") or not _is_text(entry.name):
            return False
        wanted = not self.suffixes or entry.name.lower().endswith(self.suffixes)
        return wanted or entry.is_dir(follow_symlinks=False)

    def _entry(self, folder: int, name: str, path: str) -> tuple[Entry | None, bool]:
        target_status = os.stat(name, dir_fd=folder, follow_symlinks=False)
        if (target_status.st_dev, target_status.st_ino) in self._private:
            return None, False
        if stat.S_ISDIR(target_status.st_mode):
            return (None if self.suffixes else _as_entry(path + name, target_status)), True
        if stat.S_ISLNK(target_status.st_mode):
            target_status = self._behind(path + name)
        return (_as_entry(path + name, target_status) if stat.S_ISREG(target_status.st_mode) else None), False

    def _behind(self, path: str) -> os.stat_result:
        """Return the status of the target of a link.

        Raises:
            OSError: the target isn't in the project.
        """
        try:
            with self.places.at(path) as place:
                status = place.look()
        except Trouble:
            status = None
        if status is None:
            raise FileNotFoundError(path)
        return status


def moment(seconds: float) -> str:
    """Return a time since 1970 [s] as text in UTC."""
    try:
        return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="seconds")
    except (OverflowError, OSError, ValueError):
        return datetime.fromtimestamp(0, UTC).isoformat(timespec="seconds")


def _as_entry(path: str, status: os.stat_result) -> Entry:
    is_folder = stat.S_ISDIR(status.st_mode)
    return Entry(path, 0 if is_folder else status.st_size, moment(status.st_mtime), is_folder)


def _is_text(name: str) -> bool:
    return not any("\ud800" <= character <= "\udfff" for character in name)
