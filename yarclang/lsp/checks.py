"""Run the checks of `yarc check` for each kind of open text: program, cell, robot or project."""

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
"""Smallest number of lines of a program whose syntax errors are reported before its first check. A shorter
program is checked nearly as soon as it is parsed.
"""


class Checks:
    """Checks open texts, all of them with the same options."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._analyst = Analyst(options)
        self.texts: Mapping[Path, SourceFile] = NO_TEXTS
        """The open texts by path. The mapping is replaced, never changed, because threads read it."""

    def check(
        self,
        document: Document,
        plans: bool,
        begun: Checked | None,
        is_stale: Callable[[], bool],
        early: Callable[[Checked], None] | None = None,
    ) -> Checked | None:
        """Check a text that is open in the editor.

        Args:
            document: the text.
            plans: True to plan and prove motions.
            begun: results of this text without planning, if they exist.
            is_stale: function that returns True if nobody waits for the results any more. It is called
                between motions.
            early: called with the results when all motions are planned, before they are proved.

        Returns:
            The results. None if the work was cancelled, or if `plans` is False and the text describes a cell,
            robot or project: such a text is checked only once.
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
        except Exception as error:  # a bug of ours: show it, and go on with the next edit
            return Checked((failure(error, document.source),), document.source)

    def syntax(self, document: Document) -> tuple[Diagnostic, ...] | None:
        """Return the syntax errors of a long program, before its names are resolved; None for other texts."""
        if not document.is_program or len(document.source.lines) < _LONG:
            return None
        return tuple(one for one in parse(document.source).diagnostics if one.family == SYNTAX)

    def of_text(self, source: SourceFile, folder: Path) -> Checked:
        """Run all checks on a program that isn't open in the editor."""
        found = self._look(source, folder, quick=False)
        assert found is not None  # it can't be cancelled
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
        # The copy shares the caches. Threads that are running keep the texts that were open when they began.
        analyst = copy(self._analyst)
        analyst.options = replace(analyst.options, texts=self.texts)
        return analyst.analyse(source, folder, quick=quick, begun=begun, cancelled=is_stale, early=early)

    def _described(self, document: Document) -> Checked:
        """Check a text that isn't a program: the file of a cell (for the robot of its folder), of a robot or
        of a project.

        A table of waypoints has no findings of its own, because it is checked by the programs that name it.
        """
        if document.is_table:
            return Checked(())
        name = document.path.name.lower() if document.path else ""
        if name == FILE_NAME:
            return Checked(in_order(check_project(document.source, document.folder, self.texts)))
        if name == DESCRIPTION:
            return Checked(in_order(read_robot(document.source, document.folder).diagnostics))
        robot = robot_for(document.folder, self._options.robot, self.texts).value
        return Checked(in_order(check_cell(document.source, document.folder, robot)))
