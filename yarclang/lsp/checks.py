"""Which check an open text gets: a program's, a cell's, a robot's, a project's. All of them are those of `yarc check`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from yarclang.diagnostics import in_order
from yarclang.lsp.documents import Document
from yarclang.pipeline.cells import check_cell
from yarclang.pipeline.checking import Checked, check_text
from yarclang.pipeline.inputs import Options, robot_for
from yarclang.pipeline.project import FILE_NAME, read_project
from yarclang.pipeline.sources import NO_TEXTS
from yarclang.robot.description import read_robot
from yarclang.robot.library import DESCRIPTION
from yarclang.source import SourceFile

Progress = Callable[[str, int, int], None]


class Checks:
    """Checks texts for options that hold for all of them."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self.texts: Mapping[Path, SourceFile] = NO_TEXTS
        """The texts that are open, by their paths; never changed in its place, since threads read it."""

    def check(self, document: Document, plans: bool, progress: Progress) -> Checked | None:
        """What is to be said of a text.

        Args:
            document: the text.
            plans: whether motions are planned and proved.
            progress: called while that goes on; what it raises ends the work.

        Returns:
            None where there is nothing to say yet: a description is checked once.
        """
        if document.is_program:
            options = replace(self._options, progress=progress, texts=self.texts)
            return check_text(document.source, document.folder, options, plans=plans)
        if not plans:
            return None
        return self._described(document)

    def of_text(self, source: SourceFile, folder: Path) -> Checked:
        """All that is to be said of a program that is nowhere open."""
        return check_text(source, folder, replace(self._options, texts=self.texts))

    def forget(self, uri: str) -> None:
        """A text was closed: what was kept for it isn't needed."""

    def _described(self, document: Document) -> Checked:
        """A cell's file, for the robot that its folder is for; or a robot's, or a project's."""
        name = document.path.name.lower() if document.path else ""
        if name == FILE_NAME:
            return Checked(in_order(read_project(document.source, document.folder).diagnostics))
        if name == DESCRIPTION:
            return Checked(in_order(read_robot(document.source, document.folder).diagnostics))
        robot = robot_for(document.folder, self._options.robot).value
        return Checked(in_order(check_cell(document.source, document.folder, robot)))
