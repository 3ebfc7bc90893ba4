"""A program's file to what can be run."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from yarclang.certify.judge import certify_text
from yarclang.cli.work import Progress, options_from
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.inputs import open_program
from yarclang.pipeline.jobs import Papers, job_of_text
from yarclang.pipeline.parts import motion_number, part
from yarclang.pipeline.sources import read_source
from yarclang.pipeline.stages import Compiled, Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.runtime.job import Job


@dataclass(frozen=True, slots=True)
class Loaded:
    """What is to be run: `job`, the whole of it; `steps`, its commands one by one if that is wanted; `plan` and `request`,
    if the program itself is known. `moved` says that the job begins in the middle of the program.
    """

    job: Job
    steps: tuple[Job, ...]
    plan: MotionPlan | None
    request: Request | None
    moved: bool


Found = tuple[Diagnostic, ...]


def load(file: str, first: str | None, options: dict[str, Any]) -> tuple[Loaded | None, Found]:
    """Compile a program, or read a compiled one and judge it again.

    Args:
        file: a .yarc or .pmc file.
        first: the index of the command to begin with, or None.
        options: of the command line.

    Returns:
        None where an error forbids to run it; all findings.
    """
    result = _compiled_before(file, options) if file.endswith(".pmc") else _compile(file, first, options)
    return (None if has_errors(result.diagnostics) else result.value), in_order(result.diagnostics)


def _compiled_before(file: str, options: dict[str, Any]) -> Result[Loaded]:
    read = read_source(file)
    if read.value is None:
        return Result(None, read.diagnostics)
    source = read.value
    named = re.search(r"^; robot (\S+) ", source.text, re.MULTILINE)
    robot = load_robot(options["robot"] or (named[1] if named else ""))
    if robot.value is None:
        return Result(None, robot.diagnostics)
    made = job_of_text(source.text, robot.value, Path(file).name)
    if made.value is None:
        return Result(None, (*robot.diagnostics, *made.diagnostics))
    judged = certify_text(source.text, robot.value, source)
    diagnostics = (*robot.diagnostics, *judged.diagnostics)
    certificate = json.dumps(judged.value.to_json()) if judged.value else ""
    job = job_of_text(source.text, robot.value, Path(file).name, Papers("", certificate)).value
    return Result(Loaded(job, (), None, None, False) if job else None, diagnostics)


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
        begin = 0
        whole = compiled.value
        if first is not None:
            number = motion_number(plan, first)
            if isinstance(number, Diagnostic):
                return Result(None, (*found, number))
            begin = number
            rest = part(plan, request, begin)
            found = (*found, *rest.diagnostics)
            if rest.value is None:
                return Result(None, found)
            whole = rest.value
        name, text = Path(file).name, plan.program.source.text
        job = _job(whole, name, text)
        steps: list[Job] = []
        if options["step"]:
            for number in range(begin, len(plan.motions)):
                one = part(plan, request, number, number + 1)
                if one.value is None:
                    return Result(None, (*found, *one.diagnostics))
                offset = float(plan.starts[number] - plan.starts[begin])
                steps.append(_job(one.value, name, text, offset))
    return Result(Loaded(job, tuple(steps), plan, request, begin > 0), found)


def _job(compiled: Compiled, name: str, source: str, offset: float = 0.0) -> Job:
    """A compiled program as a job; what yarcc has just written is always readable."""
    papers = Papers(source, json.dumps(compiled.certificate.to_json()))
    made = job_of_text(compiled.text, compiled.plan.robot, name, papers, offset)
    assert made.value is not None, made.diagnostics
    return made.value


def job_of_compiled(compiled: Compiled, name: str) -> Job:
    """A program of our own, such as an approach, as a job."""
    return _job(compiled, name, compiled.program.source.text)
