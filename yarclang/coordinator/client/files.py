"""A client's actions on programs in files, and conversion of the session to a program."""

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
    """Group of a client's actions: load programs, and convert the session to a program."""

    async def load(self, source: Source, *, here: bool = False, as_now: bool = True) -> Result[Loaded]:
        """Compile and prove a program for this robot, or verify a compiled program.

        Args:
            source: location of the program, and options of the compiler.
            here: True if a program without START begins at the robot's present position.
            as_now: True to assume that the cell's parts are in their present places; False to assume the
                places that the cell's file gives.

        Returns:
            The program; None if an error forbids running it.

        Raises:
            Trouble: only if `here` is True: the robot is moving, or there is no connection.
        """
        coordinator = self._coordinator
        stands = await coordinator.stands() if here else None
        source = replace(source, present=coordinator.carrying.kept.now if as_now else None)
        made: Result[Loaded] = await coordinator.plan(load, source, coordinator.robot, stands)
        return made

    def saved(self, folder: Path | None = None) -> str:
        """Return the session as a program with the same effect.

        Args:
            folder: folder for which the program is written: file names in it become relative to this folder.
                None: the session's folder.
        """
        coordinator = self._coordinator
        return coordinator.history.saved(coordinator.lines, coordinator.planner.folder, folder)

    def save(self, path: Path) -> None:
        """Write the session to a file as a program.

        Raises:
            Trouble: the file can't be written.
        """
        write_program(path, self.saved(path.parent))


def write_program(path: Path, text: str) -> None:
    """Write a program to a file.

    Raises:
        Trouble: the file can't be written.
    """
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        reason = reason_of(error)
        raise Trouble(f"{path} can't be written: {reason}", "choose another place") from None
