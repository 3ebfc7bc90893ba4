"""A text in an editor with its statements and names, and the results of checking it so far. All questions
about the text are answered from these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from yarclang.assist.sketch import Sketch
from yarclang.assist.unchanged import Unchanged, unchanged
from yarclang.certify.certificate import CommandCertificate
from yarclang.hir import Program, Step
from yarclang.motion.plan import PlannedMotion
from yarclang.pipeline.checking import Checked
from yarclang.pipeline.incremental import Analysis
from yarclang.pipeline.stages import context_of
from yarclang.robot.model import Robot
from yarclang.semantics.control.unroll import declared_names
from yarclang.semantics.names.scope import Scope


def no_module(name: str) -> Sketch | None:  # noqa: ARG001
    """Return None for any module name. This is the value of `View.module` for a text without modules."""
    return None


@dataclass(frozen=True, eq=False)
class View:
    """A text in an editor, and the results of checking it so far.

    Attributes:
        sketch: statements and names of the text.
        checked: result of checking this text; None until it is ready.
        robot: robot of this text, or of an older version.
        module: function that returns a module by its name in upper case.
        older: view of the last version that could be planned.
    """

    sketch: Sketch
    checked: Checked | None = None
    robot: Robot | None = None
    module: Callable[[str], Sketch | None] = no_module
    older: View | None = None

    @property
    def is_planned(self) -> bool:
        """Return True if this text has a plan."""
        return self.checked is not None and self.checked.plan is not None

    def planned_at(self, line: int) -> tuple[View, int] | None:
        """Return the view that has the planned motions of a line, and the number of the line in this view.

        If the motions of the current text are planned, this is the view of the current text. Otherwise,
        because of errors or because the plan isn't ready, it is the view of the last version that could be
        planned. None if there is no such version, or if the line has changed since then.
        """
        if self.is_planned:
            return self, line
        if self.older is None:
            return None
        statement = self.sketch.statement_at(line)
        there = self._same.then(line)
        known = self.older.sketch.statement_at(there) if there is not None else None
        same = statement is not None and known is not None and known.at_line(0) == statement.at_line(0)
        return (self.older, there) if same and there is not None else None

    @cached_property
    def _same(self) -> Unchanged:
        older = self.older.sketch.source.lines if self.older else ()
        return unchanged(older, self.sketch.source.lines)

    @property
    def program(self) -> Program | None:
        """Return the checked program, if it is ready."""
        return self.checked.program if self.checked else None

    @cached_property
    def scope(self) -> Scope | None:
        """Return the meanings of the names that the program declares outside of blocks; None if the robot
        isn't known.
        """
        opened = self.checked.opened if self.checked else None
        if opened is None:
            return None
        return declared_names(opened.module, context_of(opened.request))

    @cached_property
    def _analysis(self) -> Analysis | None:
        return Analysis(self.checked) if self.checked else None

    def steps_in(self, line: int) -> tuple[int, ...]:
        """Return the numbers of the steps that the statement in a line of this text produces."""
        statement = self.sketch.statement_at(line)
        return self._analysis.steps_by_line.get(statement.line, ()) if statement and self._analysis else ()

    def step(self, number: int) -> Step:
        """Return a step of the program, which must exist."""
        assert self.program is not None
        return self.program.steps[number]

    def motion(self, number: int) -> tuple[PlannedMotion, float] | None:
        """Return the plan of a step and the time at which it begins [s]; None if it isn't planned."""
        found = self._analysis.motions.get(number) if self._analysis else None
        return None if found is None else (found, self._begins[number])

    @cached_property
    def flowing(self) -> frozenset[int]:
        """Return the steps of the motions that are blended with a neighbour."""
        plan = self.checked.plan if self.checked else None
        motions = plan.motions if plan else ()
        begins = [later.step for before, later in pairwise(motions) if before.flows]
        return frozenset((*begins, *(motion.step for motion in motions if motion.flows)))

    @cached_property
    def _begins(self) -> dict[int, float]:
        """Return the times at which the motions begin [s], by step."""
        plan = self.checked.plan if self.checked else None
        return {motion.step: plan.schedule.clocks[motion.step] for motion in plan.motions} if plan else {}

    def proved(self, number: int) -> CommandCertificate | None:
        """Return the certificate of a step."""
        return self._analysis.proofs.get(number) if self._analysis else None
