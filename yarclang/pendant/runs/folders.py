"""Folders that contain logs: the project's folder, and the folder in which this robot's motions are
logged.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from yarclang.pendant.messages.runs import Place
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.runtime.actions import Trouble

_LOGS = (".mcap",)
_MOST = 10_000
"""Most files that are listed."""


@dataclass(frozen=True, slots=True)
class LogFile:
    """A file with the name of a log.

    Attributes:
        place: folder that contains it.
        file: path in this folder.
        size: size [bytes].
        changed: time of the last change (UTC).
    """

    place: Place
    file: str
    size: int
    changed: str


class LogFolders:
    """The two folders with logs. All functions wait for the disk: call them in a thread.

    Args:
        project: the project's folder.
        logs: folder or file for logs of motions; None if unknown.
        database: database of the pendant, which is inaccessible.
    """

    def __init__(self, project: ProjectFolder, logs: Path | None, database: Path) -> None:
        self._project = project
        self._database = database
        self._logs = logs
        self._other: ProjectFolder | None = None

    @property
    def folder(self) -> str:
        """Folder for logs of motions; empty if unknown."""
        return "" if self._logs is None else str(self._folder())

    @property
    def is_elsewhere(self) -> bool:
        """True if motions are logged outside of the project."""
        return self._elsewhere() is not None

    def _folder(self) -> Path:
        assert self._logs is not None
        is_file = self._logs.suffix.lower() in _LOGS or self._logs.is_file()
        return self._logs.parent if is_file else self._logs

    def files(self) -> tuple[tuple[LogFile, ...], bool]:
        """Return the logs, last changed first, and True if there may be more."""
        found, cut = self._project.with_suffix(_LOGS, _MOST)
        listed = [LogFile("project", one.file, one.size, one.changed) for one in found]
        if (other := self._elsewhere()) is not None:
            more, also = other.with_suffix(_LOGS, _MOST)
            cut = cut or also
            listed += [
                LogFile("logs", one.file, one.size, one.changed) for one in more if "/" not in one.file
            ]
        return tuple(sorted(listed, key=lambda one: one.changed, reverse=True)), cut

    def _elsewhere(self) -> ProjectFolder | None:
        """Return the folder in which motions are logged, if it exists and is outside of the project."""
        if self._logs is None:
            return None
        folder = self._folder()
        if not folder.is_dir() or folder.resolve().is_relative_to(self._project.root):
            return None
        if self._other is None or self._other.root != folder.resolve():
            self._other = ProjectFolder(folder, self._database)
        return self._other

    @contextmanager
    def opened(self, place: Place, file: str) -> Iterator[tuple[int, os.stat_result, str]]:
        """Open a log for reading. Return its descriptor, its status, and its name with links resolved.

        Args:
            place: folder that contains it.
            file: path in that folder.

        Raises:
            Trouble: there is no such log.
        """
        folder = self._project if place == "project" else self._elsewhere()
        if folder is None or not file.lower().endswith(_LOGS) or (place == "logs" and "/" in file):
            raise Trouble("there is no such log", "look at the list of runs", "missing")
        with folder.opened(file) as found:
            yield found
