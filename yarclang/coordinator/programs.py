"""From a program's file to what can be run: the whole program, its rest from a command on, or its commands
one by one.
"""

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
from yarclang.pipeline.leaving import leaving
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
from yarclang.pipeline.shifting import shifted
from yarclang.pipeline.stages import CellNow, Compiled, Request, compile_module
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Replanned
from yarclang.runtime.job import Job
from yarclang.runtime.standing import off_the_start

APPROACH = "approach"
"""Name of the way to a program's start."""


Behind = Callable[[int, Array, "tuple[int, ...] | None"], "Replanned | str"]
"""Plans what is known only at run time: from a motion's number, the robot's position (n,) [rad or m], and the
values of an OFFSET's registers (None: after a search).
"""


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """A program that can be run.

    Attributes:
        program: job of the whole program.
        rest: job that is run first: the whole program, or its rest from a command on.
        steps: jobs of the single commands of `rest`, if they are wanted.
        plan: plan of the program, if the program itself is known and not only its text.
        begins_within: True if a first command was named.
        origins: finds the source of its commands.
        cell: cell on the way to its start, for a program of which only the text is known.
        spans: for each of `steps`, or for `rest` and then the whole program: its motions in the plan, from
            the first to the one after the last.
        assumed: places of the cell's parts at its beginning, as proved; None: the cell has none.
        first_step: step of the plan with which `rest` begins, if a command was named.
        text_plan: plan for a controller text, from which its effect on parts is derived.
        behind: plans the rest after a motion that an input has ended, or the lines of an OFFSET; None:
            impossible.
        leave: plans the way back and out after an input has held a motion, from the way's name, the motion's
            number, the time of the plan [s] and the robot's position (n,) [rad or m]; None: impossible.
        again: compiles the same program with its parts elsewhere; None: impossible.
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
    behind: Behind | None = None
    leave: Callable[[str, int, float, Array], tuple[Job, ...] | str] | None = None

    @property
    def around(self) -> Cell | None:
        """Return the cell of the program."""
        return self.plan.program.cell if self.plan is not None else self.cell

    @property
    def around_start(self) -> Cell | None:
        """Return the cell for the way to the start of `rest`, with its parts where they are then."""
        if self.around is None or self.assumed is None:
            return self.around
        return presently(self.around, Present(self.assumed))

    @property
    def name(self) -> str:
        """Return the name for people."""
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
    """Compile a program so that it can be run.

    Args:
        opened: parsed program, its robot and its settings.
        name: name of the program for people.
        first: index of the command to begin with, or None.
        by_steps: True if its commands are run one by one.
        compiled: existing result of compiling it, with the findings to report.
        present: current places of its cell's parts, for a program that begins with `first`; None: as the
            program has them there.

    Returns:
        None if an error forbids running it.
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
    # Other findings about a part were already reported for the whole program.
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
        leave=ways_out(plan, asked),
    )
    return Result(loaded, found)


def behind_search(plan: MotionPlan, request: Request) -> Behind:
    """Return a function that plans the rest after a motion that an input has ended, or the lines of an
    OFFSET.
    """

    def planned(number: int, here: Array, values: tuple[int, ...] | None) -> Replanned | str:
        if values is None:
            return replanned(plan, number, here, request)
        return shifted(plan, number, here, values, request)

    return planned


def ways_out(plan: MotionPlan, request: Request) -> Callable[[str, int, float, Array], tuple[Job, ...] | str]:
    """Return a function that plans the way back and out after an input has held a motion."""
    return lambda name, number, time, here: leaving(plan, name, number, time, here, request)


def _assumed(
    plan: MotionPlan, number: int, step: int, present: CellNow | None
) -> tuple[Parts | None, tuple[int, int, Cell] | None]:
    """Return the places of parts before a step that precedes motion `number`.

    If they are known better than from the program, also return from which step on they are followed.
    """
    cell = plan.program.cell
    if cell is None or not cell.parts:
        return None, None
    # A program may have no motions, only outputs and waits.
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
    """The way from the robot to a program's start.

    `text` gives the distance (empty: the robot is at the start), `job` is a slow certified motion of all
    joints (None: none is needed, or there is none), and `findings` are the reasons why there is none. `zone`
    is the cell's start zone in which the robot stands; there the motion needs no permission. Empty: it stands
    in none.
    """

    text: str
    job: Job | None = None
    findings: tuple[Diagnostic, ...] = ()
    zone: str = ""


def way_to_start(robot: Robot, loaded: Loaded, joints: Array, around: Cell | None = None) -> Way:
    """Return the way from the robot to the start of a program.

    Args:
        robot: the robot.
        loaded: the program.
        joints: (n,) where the robot stands [rad or m].
        around: the cell around the robot; None: as the program has it at its start.
    """
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
    made = approach(robot, joints, job.start, around or loaded.around_start, loaded.program.watches)
    if made.value is None:
        return Way(text, None, made.diagnostics, name)
    return Way(text, job_of_compiled(made.value, APPROACH), zone=name)


def _along_the_path(loaded: Loaded, joints: Array, around: Cell | None) -> Compiled | None:
    """Return the way to the start along the path on which a run was stopped beside a part.

    Args:
        loaded: the program.
        joints: (n,) where the robot stands [rad or m].
        around: the cell around the robot; None: as the program has it.

    Returns:
        None if the robot doesn't stand on such a path.
    """
    if loaded.plan is None or not loaded.begins_within or not loaded.spans:
        return None
    now = None if around is None else present_of(around).parts
    return along_the_path(loaded.plan, loaded.spans[0][0], joints, now)
