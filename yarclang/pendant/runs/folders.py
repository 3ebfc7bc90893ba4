"""Folders that contain run logs: the project's folder, and the folder into which this robot's runs are
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
"""Largest number of files that are listed."""


@dataclass(frozen=True, slots=True)
class LogFile:
    """A file whose name is that of a run log.

    Attributes:
        place: which of the two folders contains the file, `project` or `logs`.
        file: path in that folder.
        size: size [bytes].
        changed: time of the last change (UTC).
    """

    place: Place
    file: str
    size: int
    changed: str


class LogFolders:
    """The two folders with run logs. All functions wait for the disk: call them in a thread.

    Args:
        project: files of the project.
        logs: folder or file into which runs are logged; None if unknown.
        database: file of the pendant's database, which must not be read as a log.
    """

    def __init__(self, project: ProjectFolder, logs: Path | None, database: Path) -> None:
        self._project = project
        self._database = database
        self._logs = logs
        self._other: ProjectFolder | None = None

    @property
    def folder(self) -> str:
        """Folder into which runs are logged; empty if unknown."""
        return "" if self._logs is None else str(self._folder())

    @property
    def is_elsewhere(self) -> bool:
        """True if runs are logged into a folder outside of the project."""
        return self._elsewhere() is not None

    def _folder(self) -> Path:
        assert self._logs is not None
        is_file = self._logs.suffix.lower() in _LOGS or self._logs.is_file()
        return self._logs.parent if is_file else self._logs

    def files(self) -> tuple[tuple[LogFile, ...], bool]:
        """Return two values: the run logs of both folders, last changed first, and True if there may be
        more.
        """
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
        """Return the folder into which runs are logged, if it exists and is outside of the project;
        otherwise None.
        """
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
        """Open a run log for reading until the context ends. Yield three values: the file's descriptor,
        status, and name with links resolved.

        Args:
            place: which of the two folders contains the log, `project` or `logs`.
            file: path in that folder.

        Raises:
            Trouble: there is no such log.
        """
        folder = self._project if place == "project" else self._elsewhere()
        if folder is None or not file.lower().endswith(_LOGS) or (place == "logs" and "/" in file):
            raise Trouble("there is no such log", "look at the list of runs", "missing")
        with folder.opened(file) as found:
            yield found
