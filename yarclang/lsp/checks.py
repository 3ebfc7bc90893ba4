"""Which check an open text gets: a program's, a cell's, a robot's, a project's. All of them are those of `yarc check`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import replace
from pathlib import Path

from yarclang.diagnostics import Diagnostic, in_order
from yarclang.findings import SYNTAX
from yarclang.lsp.documents import Document
from yarclang.pipeline.cells import check_cell, check_project
from yarclang.pipeline.checking import Checked
from yarclang.pipeline.guarding import failure
from yarclang.pipeline.incremental import Analysis, Analyst
from yarclang.pipeline.inputs import Options, robot_for
from yarclang.pipeline.project import FILE_NAME
from yarclang.pipeline.sources import NO_TEXTS
from yarclang.robot.description import read_robot
from yarclang.robot.library import DESCRIPTION
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

_LONG = 2_000
"""Lines; a shorter program is checked nearly as soon as it is read."""


class Checks:
    """Checks texts for options that hold for all of them."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._analyst = Analyst(options)
        self.texts: Mapping[Path, SourceFile] = NO_TEXTS
        """The texts that are open, by their paths; never changed in its place, since threads read it."""

    def check(
        self,
        document: Document,
        plans: bool,
        begun: Checked | None,
        is_stale: Callable[[], bool],
        early: Callable[[Checked], None] | None = None,
    ) -> Checked | None:
        """What is to be said of a text.

        Args:
            document: the text.
            plans: whether motions are planned and proved.
            begun: what was found in this very text without planning, if it was looked for.
            is_stale: whether nobody waits for it any more: asked between motions.
            early: called with what is known when all motions are planned, before they are proved.

        Returns:
            None where there is nothing to say: the work was given up; or a description is to be checked, which is done once.
        """
        try:
            if document.is_program:
                found = self._look(
                    document.source,
                    document.folder,
                    quick=not plans,
                    begun=begun,
                    is_stale=is_stale,
                    early=early,
                )
                return found.checked if found is not None else None
            return self._described(document) if plans else None
        except Exception as error:  # a bug of ours: it is shown in the text, and the next edit is looked at
            return Checked((failure(error, document.source),), document.source)

    def syntax(self, document: Document) -> tuple[Diagnostic, ...] | None:
        """The syntax errors of a long program, which are there long before its names are looked up; None of other texts."""
        if not document.is_program or len(document.source.lines) < _LONG:
            return None
        return tuple(one for one in parse(document.source).diagnostics if one.family == SYNTAX)

    def of_text(self, source: SourceFile, folder: Path) -> Checked:
        """All that is to be said of a program that is nowhere open."""
        found = self._look(source, folder, quick=False)
        assert found is not None  # nobody gives it up
        return found.checked

    def _look(
        self,
        source: SourceFile,
        folder: Path,
        *,
        quick: bool,
        begun: Checked | None = None,
        is_stale: Callable[[], bool] | None = None,
        early: Callable[[Checked], None] | None = None,
    ) -> Analysis | None:
        analyst = copy(
            self._analyst
        )  # it remembers the same: other threads look with the texts that are open then
        analyst.options = replace(analyst.options, texts=self.texts)
        return analyst.analyse(source, folder, quick=quick, begun=begun, cancelled=is_stale, early=early)

    def _described(self, document: Document) -> Checked:
        """Check a cell's file, for the robot that its folder is for; or a robot's, or a project's. Of a table of way-points, the programs that name it say what is wrong."""
        if document.is_table:
            return Checked(())
        name = document.path.name.lower() if document.path else ""
        if name == FILE_NAME:
            return Checked(in_order(check_project(document.source, document.folder, self.texts)))
        if name == DESCRIPTION:
            return Checked(in_order(read_robot(document.source, document.folder).diagnostics))
        robot = robot_for(document.folder, self._options.robot, self.texts).value
        return Checked(in_order(check_cell(document.source, document.folder, robot)))
