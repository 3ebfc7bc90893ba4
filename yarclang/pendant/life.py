"""Restart or shut-down of a pendant's process on request, and detection of changed files that require a
restart.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Literal

from yarclang.robot.description import load_robot
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

How = Literal["restart", "shut-down"]

_LARGEST = 16_000_000
"""Number of bytes that are read of a file to detect a change. No description of a robot or a cell
is longer.
"""


class Life:
    """Requests to end the pendant's process.

    Args:
        check: function that raises `Trouble` if a new process couldn't start after the end of this one.

    Attributes:
        wanted: the request, restart or shut-down; empty if there is none.
    """

    def __init__(self, check: Callable[[], None] = lambda: None) -> None:
        self.wanted: How | Literal[""] = ""
        self._check = check
        self._ends = asyncio.Event()

    async def may(self, way: How) -> None:
        """Check that the process may be restarted or shut down.

        Raises:
            Trouble: the process is ending already, or a new process couldn't start.
        """
        if self.wanted:
            raise Trouble(
                "the pendant is being ended already", "wait until its pages can be opened again", "busy"
            )
        if way == "restart":
            await asyncio.to_thread(self._check)
            if self.wanted:
                raise Trouble(
                    "the pendant is being ended already", "wait until its pages can be opened again", "busy"
                )

    def end(self, way: How) -> None:
        """Request the end of the process. The process ends when its coordinator is closed and the robot is
        at rest.
        """
        self.wanted = way
        self._ends.set()

    async def ended(self) -> None:
        """Wait until an end is requested."""
        await self._ends.wait()


class Descriptions:
    """Descriptions of robot, cell and project that the pendant's process reads only when it starts.

    Args:
        robot: robot as the process loaded it at its start.
        folder: folder of the project.
    """

    def __init__(self, robot: Robot, folder: Path) -> None:
        self._robot = robot
        self._described = robot.file
        self._project = folder / "yarc.toml"
        self._texts = {self._project: _digest(self._project)}
        self._looked: tuple[tuple[int, int] | None, str] = (None, "")

    def know(self, cell: str | None) -> None:
        """Record the file of the cell that all motions respect, with the file's present content. Do nothing
        if the file is already recorded.
        """
        if cell is not None and Path(cell) not in self._texts:
            self._texts[Path(cell)] = _digest(Path(cell))

    def waiting(self) -> tuple[tuple[str, str], ...]:
        """Return the files that have changed since the process read them, as pairs (name, text about the
        change). This is slow: call it in a thread.
        """
        found = [] if not (told := self._of_robot()) else [(self._described.name, told)]
        for path, was in self._texts.items():
            if _digest(path) != was:
                found.append((path.name, "it was changed: restart to load it"))
        return tuple(found)

    def _of_robot(self) -> str:
        stands = _stands(self._described)
        if stands is None or stands != self._looked[0]:
            self._looked = (stands, self._compared())
        return self._looked[1]

    def _compared(self) -> str:
        read = load_robot(str(self._robot.folder))
        if read.value is None:
            first = next(one for one in read.diagnostics if one.is_error)
            return f"it can no longer be loaded: {first.message}"
        if read.value.fingerprint != self._robot.fingerprint:
            return (
                "it describes another robot than the loaded one: restart to load it; the controller may "
                "need other settings"
            )
        return ""


def _stands(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return hashlib.sha256(file.read(_LARGEST)).hexdigest()
    except OSError:
        return ""
