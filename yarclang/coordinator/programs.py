"""A program's file to what can be carried out: the whole, what is left of it behind a command, or its commands one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.inputs import Opened
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.origins import Origins
from yarclang.pipeline.parts import approach, chains, motion_number, part
from yarclang.pipeline.stages import Compiled, compile_module
from yarclang.robot.model import Robot
from yarclang.runtime.job import Job
from yarclang.runtime.rest import off_the_start

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
    """

    program: Job
    rest: Job
    steps: tuple[Job, ...] = ()
    plan: MotionPlan | None = None
    begins_within: bool = False
    origins: Callable[[], Origins] = lambda: Origins(None, "its source isn't known")
    cell: Cell | None = None
    spans: tuple[tuple[int, int], ...] = ()

    @property
    def around(self) -> Cell | None:
        """The cell that the program, and the way to its start, keeps to."""
        return self.plan.program.cell if self.plan is not None else self.cell

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
) -> Result[Loaded]:
    """Compile a program to what can be run.

    Args:
        opened: the parsed program, its robot and its settings.
        name: what people call it.
        first: the index of the command to begin with, or None.
        by_steps: whether its commands are wanted one by one.
        compiled: what was made of it already, with the findings as they are to be told.

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
    number = motion_number(plan, first) if first is not None else 0
    if isinstance(number, Diagnostic):
        return Result(None, (*found, number))
    # what else is to be said of a part was said of the whole
    shorter = first is not None and plan.motions[number].step > 0
    whole = (0, len(plan.motions))
    wanted = [(number, len(plan.motions))] if shorter else []
    steps = chains(plan, number) if by_steps else []
    spans = tuple(steps) or (wanted[0] if wanted else whole, whole)
    wanted += steps
    parts: list[Job] = []
    for begin, end in wanted:
        made = part(plan, request, begin, end, with_lead=first is None)
        if made.value is None or has_errors(made.diagnostics):
            return Result(None, (*found, *made.diagnostics))
        parts.append(job_of_compiled(made.value, name, source, program.commands[begin].begins))
    rest = parts.pop(0) if shorter else program
    origins = Origins(plan.program)
    loaded = Loaded(program, rest, tuple(parts), plan, first is not None, lambda: origins, spans=spans)
    return Result(loaded, found)


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """What lies between the robot and a program's start: `text` says how far it is off (empty: it stands there), `job` is a slow certified motion of
    all joints (None: none is needed, or there is none), `findings` say why there is none.
    """

    text: str
    job: Job | None = None
    findings: tuple[Diagnostic, ...] = ()


def way_to_start(robot: Robot, loaded: Loaded, joints: Array) -> Way:
    """The way from where the robot stands (n,) [rad or m] to where a program begins."""
    job = loaded.rest
    text = off_the_start(job, joints)
    if not text:
        return Way("")
    if loaded.begins_within and job.commands:
        text = text.replace(f"where {job.name} starts", f"where {job.commands[0].title} starts")
    made = approach(robot, joints, job.start, loaded.around)
    if made.value is None:
        return Way(text, None, made.diagnostics)
    return Way(text, job_of_compiled(made.value, APPROACH))
