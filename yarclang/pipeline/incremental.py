"""A program that is looked at again and again while it is edited: only what an edit changes is worked out anew.

An `Analyst` is a memory and the very pipeline of `yarc check`; its findings, plans and certificates are those of a fresh look, to the last bit.
What is remembered, and by what:

- a statement is parsed by its text (syntax/parse.py);
- a robot and a cell are read by their files (kept.py);
- a command becomes a step by its statement and by what its names mean (semantics/recalling.py);
- where a motion leads, and its curve, by its values in SI, the joint position before it, robot, cell, grid and tolerance (motion/recalling.py);
- what of a motion is hashed, and at what angle two paths meet, by what the recalled step and paths are made of (identity.py, lint/);
- a printed move by its control points; what move lines say, by their very text (certify/cursor.py); and what the certificate proves of a stretch
  from rest to rest, by the numbers in the text and what they shall be (certify/stretches.py).

So an edit of one motion costs that motion, and those behind it as far as it moves where they begin.
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
"""Results that are remembered at most: about ten a motion, half of them small."""

LEAST_KEPT = 4_000
"""Results that are remembered however short the programs are."""


@dataclass(frozen=True, eq=False)
class Analysis:
    """What is to be said of a text, what the stages made of it as far as they came, and what belongs to which command."""

    checked: Checked

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The findings, as `yarc check` tells them."""
        return self.checked.diagnostics

    @property
    def module(self) -> Module | None:
        """The syntax tree; None where no robot is known."""
        return self.checked.opened.module if self.checked.opened else None

    @property
    def program(self) -> Program | None:
        """The checked program; it may have gaps."""
        return self.checked.program

    @property
    def plan(self) -> MotionPlan | None:
        """The plan of a program without errors."""
        return self.checked.plan

    @property
    def certificate(self) -> Certificate | None:
        """What was proved of a program without errors."""
        return self.checked.compiled.certificate if self.checked.compiled else None

    @cached_property
    def motions(self) -> Mapping[int, PlannedMotion]:
        """The planned motion of each step that is one."""
        return {motion.step: motion for motion in self.plan.motions} if self.plan else {}

    @cached_property
    def proofs(self) -> Mapping[int, CommandCertificate]:
        """What was proved of each step that is a motion."""
        return {one.step: one for one in self.certificate.commands} if self.certificate else {}

    @cached_property
    def steps_by_line(self) -> Mapping[int, tuple[int, ...]]:
        """The steps that come from a command in the program's own file, by the line in which it begins: in a loop there are many."""
        found: dict[int, list[int]] = {}
        for number, step in enumerate(self._steps):
            if not isinstance(step, Gap) and step.origin.source is self.checked.source:
                found.setdefault(step.origin.span.line, []).append(number)
        return {line: tuple(numbers) for line, numbers in found.items()}

    @property
    def _steps(self) -> tuple[Step, ...]:
        return self.program.steps if self.program else ()


ENOUGH_AT_FIRST = 1_000
"""Lines in loops and SUBs that a quick look carries out: some 0.1 s."""


class Analyst:
    """Looks at texts for options that hold for all of them, and remembers what comes again.

    Two threads may ask at once; they share what is remembered.
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
        """Look at the text of a program that belongs to a folder.

        Args:
            source: the text.
            folder: where modules, cells and settings are looked for.
            quick: only what needs no planning, and of loops and SUBs no more than ENOUGH_AT_FIRST lines.
            begun: what such a look has found in this text, if there was one: then the look goes on from there.
            cancelled: asked often whether to give up.
            early: called with what is known when all motions are planned, before they are proved, if the look goes on from a quick one.

        Returns:
            None where the work was given up; what was worked out up to there is remembered.
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
        """Remember nothing of what was."""
        self.memory.clear()
