"""Check a program repeatedly while it is edited, and compute only what an edit changes.

An `Analyst` uses a cache and the same pipeline as `yarc check`. Its findings, plans and certificates are bit
for bit those of a check without a cache. These results are cached, with these keys:

- a parsed statement, by its text (syntax/parse.py);
- a robot and a cell, by their files (kept.py);
- a command's step, by its statement and the meanings of its names (semantics/recalling.py);
- a motion's goal and curve, by its values in SI, the joint position before it, robot, cell, grid and
  tolerance (motion/recalling.py);
- a motion's hash, and the angle between two paths, by the cached steps and paths (identity.py, lint/);
- a printed move, by its control points; the meaning of move lines, by their text (certify/cursor.py); and the
  certificate of the moves from one rest to the next, by the numbers in the text and their required values
  (certify/stretches.py).

After an edit of one motion, only this motion and the later motions whose start changes are computed again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from yarclang.certify.certificate import Certificate, CommandCertificate
from yarclang.diagnostics import Diagnostic
from yarclang.hir import Gap, Program, Step
from yarclang.memory import Recent
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.pipeline.checking import Checked, check_further, check_text
from yarclang.pipeline.inputs import Options
from yarclang.progress import GivenUp, told_to, unless
from yarclang.source import SourceFile
from yarclang.syntax.ast import Module

MOST_KEPT = 60_000
"""Largest number of cached results: about ten per motion, half of them small."""

LEAST_KEPT = 4_000
"""Smallest number of results that the cache can hold, even for short programs."""


@dataclass(frozen=True, eq=False)
class Analysis:
    """The findings about a program's text, the results of the compiler's stages that were reached, and access
    to these results by command.
    """

    checked: Checked

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Return the findings, as `yarc check` reports them."""
        return self.checked.diagnostics

    @property
    def module(self) -> Module | None:
        """Return the syntax tree; None if no robot is known."""
        return self.checked.opened.module if self.checked.opened else None

    @property
    def program(self) -> Program | None:
        """Return the checked program; it may have gaps."""
        return self.checked.program

    @property
    def plan(self) -> MotionPlan | None:
        """Return the plan; None if the program has errors."""
        return self.checked.plan

    @property
    def certificate(self) -> Certificate | None:
        """Return the certificate; None if the program has errors."""
        return self.checked.compiled.certificate if self.checked.compiled else None

    @cached_property
    def motions(self) -> Mapping[int, PlannedMotion]:
        """Return the planned motions, by the numbers of their steps."""
        return {motion.step: motion for motion in self.plan.motions} if self.plan else {}

    @cached_property
    def proofs(self) -> Mapping[int, CommandCertificate]:
        """Return what is proved about each motion, by the number of its step."""
        return {one.step: one for one in self.certificate.commands} if self.certificate else {}

    @cached_property
    def steps_by_line(self) -> Mapping[int, tuple[int, ...]]:
        """Return the numbers of each command's steps, by the first line of the command, for commands in the
        program's own file. A command in a loop has many steps.
        """
        found: dict[int, list[int]] = {}
        for number, step in enumerate(self._steps):
            if not isinstance(step, Gap) and step.origin.source is self.checked.source:
                found.setdefault(step.origin.span.line, []).append(number)
        return {line: tuple(numbers) for line, numbers in found.items()}

    @property
    def _steps(self) -> tuple[Step, ...]:
        return self.program.steps if self.program else ()


ENOUGH_AT_FIRST = 1_000
"""Number of lines in loops and SUBs after which a quick check stops. Checking them takes about 0.1 s."""


class Analyst:
    """Checker of programs' texts, with the same options for all and a cache of results.

    Two threads may use it at the same time; they share the cache.
    """

    def __init__(self, options: Options | None = None, most: int = MOST_KEPT) -> None:
        self.memory = Recent(most)
        self.options = replace(options or Options(), memory=self.memory)

    def analyse(
        self,
        source: SourceFile,
        folder: Path,
        *,
        quick: bool = False,
        begun: Checked | None = None,
        cancelled: Callable[[], bool] | None = None,
        early: Callable[[Checked], None] | None = None,
    ) -> Analysis | None:
        """Check the text of a program in a folder.

        Args:
            source: the text.
            folder: folder in which modules, cells and settings are looked for.
            quick: True to check only what needs no planning, and at most ENOUGH_AT_FIRST lines of loops and
                SUBs.
            begun: result of a quick check of this text, from which the check continues; None: check from the
                start.
            cancelled: function that is called often; the check is given up if it returns True.
            early: function that gets the intermediate result when all motions are planned, but not proved
                yet. It is called only with `begun`.

        Returns:
            None if the check was given up. The results so far stay in the cache.
        """
        options = replace(self.options, enough=ENOUGH_AT_FIRST if quick else None)
        try:
            with told_to(unless(cancelled) if cancelled is not None else None):
                if begun is not None and not quick:
                    checked = check_further(begun, early)
                else:
                    checked = check_text(source, folder, options, plans=not quick)
        except GivenUp:
            if cancelled is None:
                raise
            return None
        if not quick:
            self.memory.settle(LEAST_KEPT)
        return Analysis(checked)

    def forget(self) -> None:
        """Clear the cache."""
        self.memory.clear()
