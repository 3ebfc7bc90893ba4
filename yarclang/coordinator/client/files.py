"""Programs in files, and the session as one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from yarclang.coordinator.client.part import Part
from yarclang.coordinator.loading import Source, load
from yarclang.coordinator.programs import Loaded
from yarclang.diagnostics import Result
from yarclang.files import reason_of
from yarclang.runtime.actions import Trouble


class Files(Part):
    """The part of a client that reads and writes programs."""

    async def load(self, source: Source, *, here: bool = False, as_now: bool = True) -> Result[Loaded]:
        """Compile and prove a program for this robot, or judge a compiled one.

        Args:
            source: where it is, and how it is compiled.
            here: whether a program that doesn't say START begins where the robot stands.
            as_now: True if the parts of its cell are where they are now; False: where the cell's file has them.

        Returns:
            None where an error forbids to run it.

        Raises:
            Trouble: the robot is under way, or there is no connection; both only matter where it begins `here`.
        """
        coordinator = self._coordinator
        stands = await coordinator.stands() if here else None
        source = replace(source, present=coordinator.carrying.kept.now if as_now else None)
        made: Result[Loaded] = await coordinator.plan(load, source, coordinator.robot, stands)
        return made

    def saved(self, folder: Path | None = None) -> str:
        """Return the session as a program that does the same.

        Args:
            folder: where it is to stand: names of files are written as they are seen from there. None: from the session's own.
        """
        coordinator = self._coordinator
        return coordinator.history.saved(coordinator.lines, coordinator.planner.folder, folder)

    def save(self, path: Path) -> None:
        """Write the session as a program.

        Raises:
            Trouble: the file can't be written, and why.
        """
        write_program(path, self.saved(path.parent))


def write_program(path: Path, text: str) -> None:
    """Write a program to a file.

    Raises:
        Trouble: the file can't be written, and why.
    """
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        reason = reason_of(error)
        raise Trouble(f"{path} can't be written: {reason}", "choose another place") from None
