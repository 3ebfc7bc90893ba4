"""A program's file to what can be carried out: the whole, what is left of it behind a command, or its commands one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from yarclang.cell.model import Cell, Parts, Present
from yarclang.cell.starts import start_zone
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.handling.parts import first_parts
from yarclang.handling.present import present_of, presently
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.inputs import Opened
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.origins import Origins
from yarclang.pipeline.parts import (
    approach,
    beginning,
    chains,
    leaving_before,
    part,
    parts_before,
    stands_for,
)
from yarclang.pipeline.replanning import replanned
from yarclang.pipeline.returning import along_the_path
from yarclang.pipeline.stages import CellNow, Compiled, Request, compile_module
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Replanned
from yarclang.runtime.job import Job
from yarclang.runtime.standing import off_the_start

APPROACH = "approach"
"""What the way to a program's start is called."""


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """What is to be run.

    Attributes:
        program: the whole of it.
        rest: what is run first: all of it, or what is left of it behind a command.
        steps: the commands of that one by one, if that is wanted.
        plan: of the program, if the program itself is known and not only its text.
        begins_within: whether a command was named to begin with.
        origins: looks where its commands come from.
        cell: what is around on the way to its start, of a program of which only the text is known.
        spans: which motions of the plan each of `steps` has, or what is run first and then the whole: from the first, to behind the last.
        assumed: where the parts of the cell are when it begins, as it was proved; None: the cell has none.
        first_step: the step of the plan with which what is run first begins, if a command was named.
        text_plan: of the program of a controller text: what the text does to parts is followed by it.
        behind: plans what follows a motion that an input has ended: its number, and where the robot stands (n,) [rad or m]; None: that can't be done.
        again: compiles the same program with its parts elsewhere; None: that can't be done.
    """

    program: Job
    rest: Job
    steps: tuple[Job, ...] = ()
    plan: MotionPlan | None = None
    begins_within: bool = False
    origins: Callable[[], Origins] = lambda: Origins(None, "its source isn't known")
    cell: Cell | None = None
    spans: tuple[tuple[int, int], ...] = ()
    assumed: Parts | None = None
    first_step: int | None = None
    text_plan: MotionPlan | None = None
    again: Callable[[CellNow], Result[Loaded]] | None = None
    behind: Callable[[int, Array], Replanned | str] | None = None

    @property
    def around(self) -> Cell | None:
        """The cell that the program keeps to."""
        return self.plan.program.cell if self.plan is not None else self.cell

    @property
    def around_start(self) -> Cell | None:
        """The cell that the way to the start of what is run first keeps to, with its parts where they are then."""
        if self.around is None or self.assumed is None:
            return self.around
        return presently(self.around, Present(self.assumed))

    @property
    def name(self) -> str:
        """What people call it."""
        return self.program.name


def load_program(
    opened: Opened,
    name: str,
    first: str | None = None,
    *,
    by_steps: bool = False,
    compiled: Result[Compiled] | None = None,
    present: CellNow | None = None,
) -> Result[Loaded]:
    """Compile a program to what can be run.

    Args:
        opened: the parsed program, its robot and its settings.
        name: what people call it.
        first: the index of the command to begin with, or None.
        by_steps: whether its commands are wanted one by one.
        compiled: what was made of it already, with the findings as they are to be told.
        present: where the parts of its cell are now, for a program that begins with `first`; None: as the program has them there.

    Returns:
        None where an error forbids to run it.
    """
    request = opened.request
    compiled = compiled or compile_module(opened.module, request)
    found = compiled.diagnostics
    if compiled.value is None or has_errors(found):
        return Result(None, found)
    plan = compiled.value.plan
    source = plan.program.source.text
    program = job_of_compiled(compiled.value, name, source)
    begins = beginning(plan, first) if first is not None else (0, 0)
    if isinstance(begins, Diagnostic):
        return Result(None, (*found, begins))
    number, step = begins
    # what else is to be said of a part was said of the whole
    shorter = first is not None and step > 0
    whole = (0, len(plan.motions))
    wanted = [(number, len(plan.motions))] if shorter else []
    steps = chains(plan, number) if by_steps else []
    spans = tuple(steps) or (wanted[0] if wanted else whole, whole)
    wanted += steps
    parts: list[Job] = []
    assumed, since = _assumed(plan, number, step, present)
    for begin, end in wanted:
        leads = first is not None and begin == number
        made = part(
            plan, request, begin, end, with_lead=first is None, since=since, step=step if leads else None
        )
        if made.value is None or has_errors(made.diagnostics):
            return Result(None, (*found, *made.diagnostics))
        there = program.commands[begin]
        stands = stands_for(plan, begin, step) if leads else 0.0
        offset, clock = there.begins - stands, there.clock - stands
        parts.append(job_of_compiled(made.value, name, source, offset, clock))
    rest = parts.pop(0) if shorter else program
    origins = Origins(plan.program)
    loaded = Loaded(program, rest, tuple(parts), plan, first is not None, lambda: origins, spans=spans)
    asked = Request(request.robot, tm=request.tm, tolerance=request.tolerance)
    loaded = replace(
        loaded,
        assumed=assumed,
        first_step=step if first is not None else None,
        behind=behind_search(plan, asked),
    )
    return Result(loaded, found)


def behind_search(plan: MotionPlan, request: Request) -> Callable[[int, Array], Replanned | str]:
    """Return what plans what follows a motion of a plan that an input has ended."""
    return lambda number, here: replanned(plan, number, here, request)


def _assumed(
    plan: MotionPlan, number: int, step: int, present: CellNow | None
) -> tuple[Parts | None, tuple[int, int, Cell] | None]:
    """Return where the parts are before a step in front of motion `number`, and, if that is known better than from the program, since when its parts follow from there."""
    cell = plan.program.cell
    if cell is None or not cell.parts:
        return None, None
    # a program may only set outputs and wait
    stands = plan.motions[number].curve.points[0] if plan.motions else plan.program.start
    now = None if present is None else present(cell, stands)
    if now is not None:
        known = present_of(now)
        if not known.leaving and step:
            known = replace(known, leaving=leaving_before(plan, step, known.parts))
        return known.parts, (number, step, presently(now, known))
    before = parts_before(plan, step) if step else None
    return (first_parts(cell) if before is None else before), None


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """What lies between the robot and a program's start: `text` says how far it is off (empty: it stands there), `job` is a slow certified motion of
    all joints (None: none is needed, or there is none), `findings` say why there is none.

    `zone` is the name of the cell's start zone in which the robot stands: there the motion needs nobody's word; empty: it stands in none.
    """

    text: str
    job: Job | None = None
    findings: tuple[Diagnostic, ...] = ()
    zone: str = ""


def way_to_start(robot: Robot, loaded: Loaded, joints: Array, around: Cell | None = None) -> Way:
    """The way from where the robot stands (n,) [rad or m] to where a program begins, in the cell as it is `around` the robot (None: as the program has it at its start)."""
    job = loaded.rest
    text = off_the_start(job, joints)
    if not text:
        return Way("")
    if loaded.begins_within and job.commands:
        text = text.replace(f"where {job.name} starts", f"where {job.commands[0].title} starts")
    zone = start_zone(loaded.around, joints)
    name = "" if zone is None else zone.name
    if (back := _along_the_path(loaded, joints, around)) is not None:
        return Way(text, job_of_compiled(back, APPROACH), zone=name)
    made = approach(robot, joints, job.start, around or loaded.around_start)
    if made.value is None:
        return Way(text, None, made.diagnostics, name)
    return Way(text, job_of_compiled(made.value, APPROACH), zone=name)


def _along_the_path(loaded: Loaded, joints: Array, around: Cell | None) -> Compiled | None:
    """Return the way to the start along the path on which a run was stopped beside a part; None if the robot doesn't stand there."""
    if loaded.plan is None or not loaded.begins_within or not loaded.spans:
        return None
    now = None if around is None else present_of(around).parts
    return along_the_path(loaded.plan, loaded.spans[0][0], joints, now)
