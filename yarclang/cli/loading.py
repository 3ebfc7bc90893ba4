"""A program's file to what can be run."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from yarclang.certify.judge import certify_text
from yarclang.cli.outputs import STANDARD
from yarclang.cli.work import Progress, options_from
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.inputs import open_program
from yarclang.pipeline.jobs import Papers, job_of_text
from yarclang.pipeline.origins import Origins, origins_of_text
from yarclang.pipeline.parts import chains, motion_number, part
from yarclang.pipeline.sources import read_source
from yarclang.pipeline.stages import Compiled, compile_module
from yarclang.robot.description import load_robot
from yarclang.robot.model import Robot
from yarclang.runtime.job import Job
from yarclang.source import SourceFile, Span

_COMPILED = ".pmc"
_FIRST_WORDS = "; yarcc "
_AGAIN = "it isn't as yarcc wrote it: compile the program again"


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """What is to be run.

    Attributes:
        program: the whole of it.
        rest: what is run first: all of it, or what `--from` leaves of it.
        steps: the commands of that one by one, if that is wanted.
        plan: of the program, if the program itself is known and not only its text.
        begins_within: whether a command was named to begin with.
        origins: looks where its commands come from.
    """

    program: Job
    rest: Job
    steps: tuple[Job, ...] = ()
    plan: MotionPlan | None = None
    begins_within: bool = False
    origins: Callable[[], Origins] = lambda: Origins(None, "its source isn't known")


Found = tuple[Diagnostic, ...]


def is_compiled(file: str) -> bool:
    """Whether a file is called as what yarcc writes."""
    return file.lower().endswith(_COMPILED)


def load(file: str, first: str | None, options: dict[str, Any]) -> tuple[Loaded | None, Found]:
    """Compile a program, or read a compiled one and judge it again.

    Args:
        file: a .yarc or .pmc file.
        first: the index of the command to begin with, or None.
        options: of the command line.

    Returns:
        None where an error forbids to run it; all findings.
    """
    result = _compiled_before(file, options["robot"]) if is_compiled(file) else _compile(file, first, options)
    return (None if has_errors(result.diagnostics) else result.value), in_order(result.diagnostics)


def _compiled_before(file: str, robot_name: str | None) -> Result[Loaded]:
    """A .pmc file; its header names the robot, but not where a robot of somebody's own is."""
    read = read_source(file)
    if read.value is None:
        return Result(None, read.diagnostics)
    source = read.value
    if not source.text.startswith(_FIRST_WORDS):
        message = "this isn't a text that yarcc has written"
        span = Span.on_line(1, 1, 2)
        return Result(
            None,
            (
                Diagnostic(
                    "Y1151", message, source, span, "give the program itself, or what yarcc made of it"
                ),
            ),
        )
    robot = robot_of_text(source, robot_name)
    if robot.value is None:
        return Result(None, robot.diagnostics)
    name = Path(file).name
    made = job_of_text(source.text, robot.value, name)
    if made.value is None:
        refused = (replace(one, help=one.help or _AGAIN) for one in made.diagnostics)
        return Result(None, (*robot.diagnostics, *refused))
    judged = certify_text(source.text, robot.value, source)
    found = (replace(one, help=one.help or _AGAIN) for one in judged.diagnostics)
    diagnostics = (*robot.diagnostics, *found)
    if judged.value is None or has_errors(diagnostics):
        return Result(None, diagnostics)
    papers = Papers("", json.dumps(judged.value.to_json()))
    job = job_of_text(source.text, robot.value, name, papers).value
    assert job is not None  # it was one without papers
    known = robot.value
    origins = partial(origins_of_text, source.text, Path(file).parent, known)
    return Result(Loaded(job, job, origins=origins), diagnostics)


def robot_of_text(source: SourceFile, name: str | None) -> Result[Robot]:
    """The robot that was named, which must be that of the header."""
    named = re.search(r"^; robot (\S+) (\S+)$", source.text, re.MULTILINE)
    if name is not None:
        found = load_robot(name)
        if named is None or found.value is None or found.value.name == named[1]:
            return found
        message = f"the text was made for {named[1]}, the command line says {found.value.name}"
        return Result(None, (Diagnostic("Y1163", message, source, help="leave --robot out"),))
    if named is None:
        message = "the header doesn't say for which robot the text was made"
        return Result(None, (Diagnostic("Y1163", message, source, help=_AGAIN),))
    found = load_robot(named[1])
    if found.value is not None:
        return found
    help_ = "if it is one of your own, say where it is: --robot PATH"
    placed = tuple(one if one.source else replace(one, source=source) for one in found.diagnostics)
    return Result(None, tuple(replace(one, help=help_) for one in placed))


def _compile(file: str, first: str | None, options: dict[str, Any]) -> Result[Loaded]:
    with Progress() as progress:
        opened = open_program(file, options_from(options, progress))
        if opened.value is None:
            return Result(None, opened.diagnostics)
        request = opened.value.request
        compiled = compile_module(opened.value.module, request)
        found = (*opened.diagnostics, *compiled.diagnostics)
        if compiled.value is None or has_errors(found):
            return Result(None, found)
        plan = compiled.value.plan
        name = "stdin" if file == STANDARD else Path(file).name
        source = plan.program.source.text
        program = _job(compiled.value, name, source)
        number = motion_number(plan, first) if first is not None else 0
        if isinstance(number, Diagnostic):
            return Result(None, (*found, number))
        # what else is to be said of a part was said of the whole
        shorter = first is not None and plan.motions[number].step > 0
        wanted = [(number, len(plan.motions))] if shorter else []
        if options["step"]:
            wanted += chains(plan, number)
        parts: list[Job] = []
        for begin, end in wanted:
            made = part(plan, request, begin, end, with_lead=first is None)
            if made.value is None or has_errors(made.diagnostics):
                return Result(None, (*found, *made.diagnostics))
            parts.append(_job(made.value, name, source, program.commands[begin].begins))
    rest = parts.pop(0) if shorter else program
    origins = Origins(plan.program)
    return Result(Loaded(program, rest, tuple(parts), plan, first is not None, lambda: origins), found)


def _job(compiled: Compiled, name: str, source: str, offset: float = 0.0) -> Job:
    """A compiled program as a job; what yarcc has just written is always readable."""
    papers = Papers(source, json.dumps(compiled.certificate.to_json()))
    made = job_of_text(compiled.text, compiled.plan.robot, name, papers, offset)
    assert made.value is not None, made.diagnostics
    return made.value


def job_of_compiled(compiled: Compiled, name: str) -> Job:
    """A program of our own, such as an approach, as a job."""
    return _job(compiled, name, compiled.program.source.text)
