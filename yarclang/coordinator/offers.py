"""Conversion of a text to an offer: planned and certified motions from the robot's position. The owner may
then carry the offer out. Pure: nothing moves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from yarclang.cell.model import Cell
from yarclang.certify.certificate import Certificate, CommandCertificate
from yarclang.coordinator.lines import Lines, Parts, numbered, parts_of
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.hir import AvoidMove, JointMove, PoseGoal, Program
from yarclang.lasting import NO_TIME, Lasting
from yarclang.lint.engine import lint
from yarclang.lint.rule import Surroundings
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.cells import cell_loader
from yarclang.pipeline.checking import settled
from yarclang.pipeline.inputs import Opened
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.kept import Stamp, stamp_of
from yarclang.pipeline.modules import loader
from yarclang.pipeline.project import FILE_NAME, Project, find_project
from yarclang.pipeline.stages import CellNow, Compiled, Request, certified, check_program, plan_checked
from yarclang.pipeline.trajectories import TrajectoryLoader
from yarclang.robot.kinematics.inverse import branches
from yarclang.robot.kinematics.within import beyond
from yarclang.robot.model import Array, Robot
from yarclang.runtime.job import Job
from yarclang.semantics.context import GivenCell
from yarclang.semantics.declared.whole_file import declared_robot
from yarclang.syntax.ast import Module
from yarclang.syntax.parse import parse

NAME = "session"
"""Name of a program that is created from a session."""

_SAME = 1e-6
"""Largest distance between joint positions that count as equal [rad or m]."""


@dataclass(frozen=True, slots=True)
class OfferedMotion:
    """A motion of an offer, as shown to the user.

    `title` is the index and the name of its command, `seconds` its duration, `branch` the chosen
    inverse-kinematics solution for a pose (empty if there was no choice), and `proved` the values from the
    certificate: peaks, path, clearance.
    """

    title: str
    seconds: float
    branch: str
    proved: CommandCertificate


@dataclass(frozen=True, slots=True, eq=False)
class Offer:
    """Motions and declarations of a text, which are carried out if the owner agrees.

    Attributes:
        number: number of the offer, unique within a coordinator.
        text: text as the user entered it.
        parts: declarations and commands of the text.
        start: (n,) joint positions at which the motions begin [rad or m].
        motions: motions in order; empty if nothing moves.
        findings: warnings and notes; an offer has no errors.
        compiled: text, program, plan and certificate; None if there are only declarations.
        job: job to be streamed; None if there are only declarations.
        revision: revision of the session's lines with which the offer was planned.
        takes_back: for a motion back: number of earlier motions that it drives back.
        proved_in: cell, with its parts, for which the offer is valid; None: the session's cell, or the cell
            that the offer's own lines name.
    """

    number: int
    text: str
    parts: Parts
    start: Array
    motions: tuple[OfferedMotion, ...]
    findings: tuple[Diagnostic, ...]
    compiled: Compiled | None
    job: Job | None
    revision: int
    takes_back: int = 0
    proved_in: Cell | None = None

    @property
    def duration(self) -> float:
        """Return the known time of motions and dwells, along the longest branches [s]."""
        return self.lasting.most

    @property
    def lasting(self) -> Lasting:
        """Return the duration, including the number of waits."""
        return NO_TIME if self.job is None else self.job.lasting

    @property
    def end(self) -> Array:
        """Return the position of the robot after the offer (n,) [rad or m]."""
        return self.start if self.job is None else self.job.end

    @property
    def certificate(self) -> Certificate | None:
        """Return the certificate; None if nothing moves."""
        return None if self.compiled is None else self.compiled.certificate

    @property
    def plan(self) -> MotionPlan | None:
        """Return the plan, which gives the joints as a function of time."""
        return None if self.compiled is None else self.compiled.plan

    @property
    def title(self) -> str:
        """Return the name of the offer while it is carried out."""
        return " ".join(self.text.split())[:60]


class Planner:
    """Plans offers for one robot, with the modules, cells and yarc.toml of one folder.

    Args:
        robot: the robot.
        folder: folder of the session.
        tm: longest segment time [ms]; None: that of the robot.
        cell: path of a cell.toml for all motions; None: the one that yarc.toml names, if any.
        present: returns the cell with its parts at their present places; None: the parts are in the places
            that the cell's file gives.

    Attributes:
        generation: number that grows when the cell or yarc.toml is read again. Proofs of an earlier
            generation may be invalid.
    """

    def __init__(
        self,
        robot: Robot,
        folder: Path,
        tm: float | None = None,
        cell: str | None = None,
        present: CellNow | None = None,
    ) -> None:
        self.robot = robot
        self.folder = folder
        self.generation = 0
        self._named = cell
        self._project = Project(folder)
        self._cells = cell_loader(folder, robot)
        self._settings: Stamp = ()
        self._keeps = False
        self._request = Request(
            robot,
            tm=tm,
            load=loader(folder),
            index_needed=False,
            present=present,
            load_table=TrajectoryLoader(folder),
        )
        self._read()

    def renewed(self) -> bool:
        """Read the cells again if one of their files has changed. Return True if they were read again. Waits
        for the disk.

        After a cell has been named, the robot respects it until the coordinator ends. As long as no cell has
        been named, yarc.toml is read again as well.
        """
        if self._cells.is_current and (self._keeps or self._settings == stamp_of(self._places())):
            return False
        self._read()
        self.generation += 1
        return True

    def _places(self) -> tuple[Path, ...]:
        """Return the paths at which a yarc.toml would be found: in the session's folder, and in the
        folders above it.
        """
        folder = self.folder.resolve()
        return tuple(one / FILE_NAME for one in (folder, *folder.parents))

    def _read(self) -> None:
        project = self._project
        diagnostics: tuple[Diagnostic, ...] = ()
        if not self._keeps:
            self._settings = stamp_of(self._places())
            found = find_project(self.folder)
            project, diagnostics = found.value or Project(self.folder), found.diagnostics
        load_cell = cell_loader(self.folder, self.robot)
        given = load_cell.given(project, self._named)
        diagnostics = (*diagnostics, *given.diagnostics)
        around = given.value
        self._keeps = around is not None and not has_errors(diagnostics)
        if has_errors(diagnostics):  # the surroundings are unknown: refuse every text with these findings
            around = GivenCell(FILE_NAME, Result(None, diagnostics), FILE_NAME, f"repair {FILE_NAME}")
        self._project, self._cells = project, load_cell
        self._request = replace(self._request, load=loader(self.folder), load_cell=load_cell, cell=around)

    @property
    def cell(self) -> Cell | None:
        """Return the cell that applies to all motions; None if a cell can be named only by a CELL line."""
        given = self._request.cell
        return None if given is None else given.loaded.value

    def request(self, start: Array) -> Request:
        """Return the request to compile a text from the robot's position (n,) [rad or m]."""
        return replace(self._request, start=start)

    def offer(self, text: str, lines: Lines, start: Array, number: int) -> Result[Offer]:
        """Plan and certify a text that is entered after the lines of a session.

        Args:
            text: one command, declaration or block, or several.
            lines: lines of the session.
            start: (n,) position of the robot [rad or m].
            number: number of the offer.

        Returns:
            The offer; None if a finding forbids it. The findings have line numbers within the text.
        """
        typed = lines.behind(text)
        revision = lines.revision
        parsed = parse(typed.source)
        module = parsed.value
        assert module is not None  # parsing always gives a tree
        parts = _new_parts(module, typed.before)
        if not parts.commands and not parts.declarations and not parsed.diagnostics:
            return Result(None, ())
        findings = (*parsed.diagnostics, *self._of_robot(module))
        compiled: Compiled | None = None
        # Indices are needed to identify commands in loops, and commands that call a module.
        indexed = numbered(module, typed.before, lines.next_number)
        if not has_errors(findings):
            made = self._staged(indexed, start, parts)
            compiled, findings = made.value, (*findings, *made.diagnostics)
        told = settled(findings, typed.source, self._project, Opened(indexed, self._request))
        own = tuple(one for one in told if one.is_error or one.span is None or one.span.line > typed.before)
        placed = typed.placed(own)
        if has_errors(told) or (parts.commands and compiled is None):
            return Result(None, placed)
        return Result(self._made(number, text, parts, start, placed, compiled, revision), placed)

    def offered(
        self, number: int, text: str, start: Array, compiled: Result[Compiled], revision: int
    ) -> Result[Offer]:
        """Return an offer for a compiled program that the user hasn't typed, such as a motion back.

        Args:
            number: number of the offer.
            text: text of the offer, for messages.
            start: (n,) position of the robot [rad or m].
            compiled: the compiled program.
            revision: revision of the session's lines with which it was planned.
        """
        if compiled.value is None or has_errors(compiled.diagnostics):
            return Result(None, compiled.diagnostics)
        parts = Parts((), ())
        return Result(
            self._made(number, text, parts, start, compiled.diagnostics, compiled.value, revision),
            compiled.diagnostics,
        )

    def _made(
        self,
        number: int,
        text: str,
        parts: Parts,
        start: Array,
        findings: tuple[Diagnostic, ...],
        compiled: Compiled | None,
        revision: int,
    ) -> Offer:
        motions: tuple[OfferedMotion, ...] = ()
        job: Job | None = None
        if compiled is not None:
            motions = _motions(compiled)
            job = job_of_compiled(compiled, NAME, text)
        return Offer(number, text, parts, start, motions, findings, compiled, job, revision)

    def _of_robot(self, module: Module) -> tuple[Diagnostic, ...]:
        """Check that a ROBOT line in a session names this robot, and that there is no START line, which is
        only allowed in files.
        """
        findings: list[Diagnostic] = []
        declared = declared_robot(module)
        if declared is not None and declared[0].upper() != self.robot.name.upper():
            from yarclang.robot.description import load_robot

            other = load_robot(declared[0]).value
            if other is None or other.fingerprint != self.robot.fingerprint:
                message = f"the session moves {self.robot.name}, not {declared[0]}"
                findings.append(
                    Diagnostic("Y1392", message, module.source, declared[1], "omit the ROBOT line")
                )
        for one in module.statements:
            if one.index is None and one.name.name == "START":
                message = "START is for files: in a session each command starts at the robot's position"
                help_ = "move there: MOVEJ with these values"
                findings.append(Diagnostic("Y1615", message, module.source, one.whole_span, help_))
        return tuple(findings)

    def _staged(self, module: Module, start: Array, parts: Parts) -> Result[Compiled]:
        """Run all stages of the compiler, and the lint rules."""
        request = self.request(start)
        checked = check_program(module, request)
        program = checked.value
        assert program is not None  # a check always gives a program
        products: list[object] = [module, program]
        if not parts.commands:
            # Y0104, a file without a command, is normal for the declarations of a session.
            findings = tuple(one for one in checked.diagnostics if one.code != "Y0104")
            return Result(None, findings)
        planned = plan_checked(checked, request)
        findings, compiled = planned.diagnostics, None
        if planned.value is not None:
            made = certified(planned.value, request)
            findings, compiled = (*findings, *made.diagnostics), made.value
            products.append(planned.value)
            if compiled is not None:
                products.append(compiled.certificate)
        around = Surroundings(module, self.robot, program.steps, self._project.teach)
        off = {code for code, level in self._project.levels.items() if level == "off"}
        return Result(compiled, (*findings, *lint(products, around, findings, off)))


def _new_parts(module: Module, before: int) -> Parts:
    """Return the declarations and commands of a text that come after the session's lines."""
    own = replace(module, statements=tuple(one for one in module.statements if one.line > before))
    return parts_of(own)


def _motions(compiled: Compiled) -> tuple[OfferedMotion, ...]:
    plan, program = compiled.plan, compiled.program
    answer = []
    for planned, proved in zip(plan.motions, compiled.certificate.commands, strict=True):
        begin = planned.curve.points[0]
        branch = _branch(plan.robot, program, planned.step, begin, planned.waypoints[-1])
        title = f"{proved.index} {proved.name}".replace("- ", "", 1).strip()
        answer.append(OfferedMotion(title, proved.duration, branch, proved))
    return tuple(answer)


def _branch(robot: Robot, program: Program, number: int, begin: Array, chosen: Array) -> str:
    """Return the rank of the solution that was chosen for a pose, in words, for example `nearest of 8`."""
    step = program.steps[number]
    if not isinstance(step, JointMove | AvoidMove) or not isinstance(goal := step.goal, PoseGoal):
        return ""
    base_from_flange = goal.base_from_moving @ np.linalg.inv(goal.flange_from_moving)
    found, reached = branches(robot.chain, base_from_flange[None], hold=begin)
    within = [
        q for q, good in zip(found[0], reached[0], strict=True) if good and not beyond(robot.limits, q).any()
    ]
    reference = begin if goal.near is None else goal.near
    distance = float(((chosen - reference) ** 2).sum())
    nearer = sum(float(((q - reference) ** 2).sum()) < distance - _SAME for q in within)
    place = {0: "nearest", 1: "second nearest", 2: "third nearest"}.get(nearer, f"number {nearer + 1}")
    return f"{place} of {max(len(within), nearer + 1)}"
