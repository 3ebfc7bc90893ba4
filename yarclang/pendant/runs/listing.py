"""List of run logs with their summaries. A summary is cached until the file of the log changes."""

from __future__ import annotations

import os
import time
from collections import OrderedDict
from collections.abc import Callable

from yarclang.pendant.messages.runs import RunList, RunListed
from yarclang.pendant.runs.folders import LogFile, LogFolders
from yarclang.report.runs.brief import Brief, brief_of
from yarclang.runtime.actions import Trouble

MOST = 1000
"""Largest number of logs that are listed."""

_REMEMBERED = 4 * MOST
_FRESH = 5.0
"""Time after its last change for which a log without an end counts as being written [s]. After this time, the
log counts as cut off.
"""

_UNREADABLE = Brief("", "", "", "", "", "", is_known=False, is_whole=False)


class Listing:
    """The list of run logs. `listed` waits for the disk: call it in a thread.

    Args:
        folders: folders with run logs.
        wall: returns the time of day [s].
    """

    def __init__(self, folders: LogFolders, wall: Callable[[], float] = time.time) -> None:
        self._folders = folders
        self._wall = wall
        self._known: OrderedDict[LogFile, Brief] = OrderedDict()

    def listed(self, written: str) -> RunList:
        """Return the summaries of the run logs, last changed first.

        Args:
            written: file name of the log that is being written now; empty if there is none.
        """
        files, cut = self._folders.files()
        shown = tuple(self._shown(one, written) for one in files[:MOST])
        return RunList(runs=shown, cut=cut or len(files) > MOST, folder=self._folders.folder)

    def _shown(self, file: LogFile, written: str) -> RunListed:
        brief, age = self._known.get(file), _FRESH
        if brief is None:
            brief, age = self._read(file)
        name = file.file.rpartition("/")[2]
        is_open = not brief.is_whole and brief is not _UNREADABLE
        is_written = is_open and (name == written or 0.0 <= age < _FRESH)
        return RunListed(
            place=file.place,
            file=file.file,
            size=file.size,
            changed=file.changed,
            state="unreadable"
            if not brief.is_known
            else "under way"
            if is_written
            else "cut off"
            if is_open
            else "whole",
            program=brief.program,
            robot=brief.robot,
            controller=brief.controller,
            client=brief.client,
            started=brief.started,
            duration_s=None if brief.duration is None else round(brief.duration, 3),
            well=brief.well,
            what=brief.what,
            code=brief.code,
        )

    def _read(self, file: LogFile) -> tuple[Brief, float]:
        """Return two values: the summary of a log, and the time since the log's last change [s]."""
        try:
            with self._folders.opened(file.place, file.file) as (handle, told, _):
                summary = brief_of(lambda at, count: os.pread(handle, count, at), told.st_size)
                age = self._wall() - told.st_mtime
        except (Trouble, OSError):
            return _UNREADABLE, _FRESH  # the log has been removed, or can't be read
        brief = summary or _UNREADABLE
        if brief.is_whole or (summary is None and age > _FRESH):
            self._known[file] = brief
            while len(self._known) > _REMEMBERED:
                self._known.popitem(last=False)
        return brief, age
