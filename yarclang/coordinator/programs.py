"""Preparation of a program so that it can be run: as a whole, from a given command on, or command
by command.
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
"""Name of the motion to a program's start."""


Behind = Callable[[int, Array, "tuple[int, ...] | None"], "Replanned | str"]
"""Type of a function that plans while a program runs: either the rest of the program after a search, or the
motions of an OFFSET.

Its arguments are the number of the search or of the first motion, the robot's position (n,) [rad or m], and
the values of the OFFSET's registers (None after a search).
"""


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """A program that can be run.

    Attributes:
        program: job of the whole program.
        rest: job that is run first: the whole program, or its part from a given command on.
        steps: jobs of the single commands of `rest`, if they are run one by one.
        plan: plan of the program; None if only the controller text is known.
        begins_within: True if the run begins at a given command.
        origins: finds the positions of the program's commands in the source file.
        cell: cell for the motion to the start; only for a program of which only the controller text is known.
        spans: ranges of motions in the plan, each as the first motion and one after the last. With `steps`:
            the range of each step. Otherwise: the range of `rest`, and the range of the whole program.
        assumed: places of the cell's parts at the beginning, as assumed in the proof; None: the cell has no
            parts.
        first_step: step of the plan at which `rest` begins; None if no command was given.
        text_plan: plan that was reconstructed from a controller text, to derive the effect of the text on the
            cell's parts.
        behind: plans the rest of the program after an input has ended a motion, or the motions of an OFFSET;
            None if this is impossible.
        leave: plans the retreat after an input has held a motion: back on the path, then the motions out.
            Arguments: the name of the motions out, the number of the held motion, the time of the plan [s]
            and the robot's position (n,) [rad or m]. None if this is impossible.
        again: compiles the same program for other places of the cell's parts; None if this is impossible.
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
        """Return the cell of the program; None if it has none."""
        return self.plan.program.cell if self.plan is not None else self.cell

    @property
    def around_start(self) -> Cell | None:
        """Return the cell with which the motion to the start of `rest` is planned. Its parts are in the
        places that the proof assumes at this start. None if there is no cell.
        """
        if self.around is None or self.assumed is None:
            return self.around
        return presently(self.around, Present(self.assumed))

    @property
    def name(self) -> str:
        """Return the name of the program, for messages."""
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
        name: name of the program, for messages.
        first: index of the command at which the run begins; None: the beginning.
        by_steps: True if its commands are run one by one.
        compiled: the compiled program with the findings to report, if it was compiled before; None: compile
            it.
        present: returns the cell with its parts at their present places, for a program that begins at
            `first`; None: the parts are in the places that the program assumes there.

    Returns:
        The program; None if an error forbids running it.
    """
    request = opened.request
    compiled = compiled or compile_module(opened.module, request)
    diagnostics = compiled.diagnostics
    if compiled.value is None or has_errors(diagnostics):
        return Result(None, diagnostics)
    plan = compiled.value.plan
    source = plan.program.source.text
    program = job_of_compiled(compiled.value, name, source)
    begins = beginning(plan, first) if first is not None else (0, 0)
    if isinstance(begins, Diagnostic):
        return Result(None, (*diagnostics, begins))
    number, step = begins
    # Compile the sections of the program that are run separately. Of their findings, only errors are
    # returned: the others were already reported when the whole program was compiled.
    shorter = first is not None and step > 0
    whole = (0, len(plan.motions))
    missing_steps = [(number, len(plan.motions))] if shorter else []
    steps = chains(plan, number) if by_steps else []
    spans = tuple(steps) or (missing_steps[0] if missing_steps else whole, whole)
    missing_steps += steps
    parts: list[Job] = []
    assumed, since = _assumed(plan, number, step, present)
    for begin, end in missing_steps:
        leads = first is not None and begin == number
        compiled_part = part(
            plan, request, begin, end, with_lead=first is None, since=since, step=step if leads else None
        )
        if compiled_part.value is None or has_errors(compiled_part.diagnostics):
            return Result(None, (*diagnostics, *compiled_part.diagnostics))
        there = program.commands[begin]
        stands = stands_for(plan, begin, step) if leads else 0.0
        offset, clock = there.begins - stands, there.clock - stands
        parts.append(job_of_compiled(compiled_part.value, name, source, offset, clock))
    rest = parts.pop(0) if shorter else program
    origins = Origins(plan.program)
    loaded = Loaded(program, rest, tuple(parts), plan, first is not None, lambda: origins, spans=spans)
    request_as_asked = Request(request.robot, tm=request.tm, tolerance=request.tolerance)
    loaded = replace(
        loaded,
        assumed=assumed,
        first_step=step if first is not None else None,
        behind=behind_search(plan, request_as_asked),
        leave=ways_out(plan, request_as_asked),
    )
    return Result(loaded, diagnostics)


def behind_search(plan: MotionPlan, request: Request) -> Behind:
    """Return a function that plans while the program runs: either the rest of the program after an input has
    ended a motion (a search), or the motions of an OFFSET.
    """

    def planned(number: int, position: Array, values: tuple[int, ...] | None) -> Replanned | str:
        if values is None:
            return replanned(plan, number, position, request)
        return shifted(plan, number, position, values, request)

    return planned


def ways_out(plan: MotionPlan, request: Request) -> Callable[[str, int, float, Array], tuple[Job, ...] | str]:
    """Return a function that plans the retreat after an input has held a motion: back on the path, then the
    motions out.
    """
    return lambda name, number, time, here: leaving(plan, name, number, time, here, request)


def _assumed(
    plan: MotionPlan, number: int, step: int, present: CellNow | None
) -> tuple[Parts | None, tuple[int, int, Cell] | None]:
    """Find the places of the cell's parts before the step `step`. `number` is the first motion from this step
    on.

    Returns:
        The present places if they are known, otherwise the places that the program assumes; None if the cell
        has no parts. The second value is None, unless the present places are returned: then it is the motion,
        the step, and the cell with these places.
    """
    cell = plan.program.cell
    if cell is None or not cell.parts:
        return None, None
    # A program may contain only outputs and waits, and no motion.
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
    """The motion from the robot's position to a program's start.

    `text` says how far the robot is from the start (empty: the robot is there). `job` is a slow certified
    motion of all joints. It is None if no motion is needed, or if none is possible; in the second case
    `findings` are the reasons. `zone` is the name of the cell's start zone in which the robot stands (empty:
    in none); from a start zone, the motion needs no permission.
    """

    text: str
    job: Job | None = None
    findings: tuple[Diagnostic, ...] = ()
    zone: str = ""


def way_to_start(robot: Robot, loaded: Loaded, joints: Array, around: Cell | None = None) -> Way:
    """Return the motion from the robot's position to the start of a program.

    Args:
        robot: the robot.
        loaded: the program.
        joints: (n,) position of the robot [rad or m].
        around: the cell with its parts at their present places; None: the parts are in the places that the
            program assumes at its start.
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
    """Return a motion to the start of a run that leads along the program's own path. It is for a run that was
    stopped while the robot touched a part.

    Args:
        loaded: the program.
        joints: (n,) position of the robot [rad or m].
        around: the cell with its parts at their present places; None: the parts are in the places that the
            program assumes.

    Returns:
        The motion; None if the robot isn't on the program's path.
    """
    if loaded.plan is None or not loaded.begins_within or not loaded.spans:
        return None
    now = None if around is None else present_of(around).parts
    return along_the_path(loaded.plan, loaded.spans[0][0], joints, now)
