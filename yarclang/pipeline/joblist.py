"""Compile the jobs of a project: numbered programs that may follow each other in any order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from yarclang.diagnostics import Diagnostic, has_errors
from yarclang.frozen import frozen
from yarclang.hir import Finish
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.project import Project
from yarclang.pipeline.stages import Compiled, compile_module
from yarclang.progress import tell
from yarclang.robot.model import Array
from yarclang.runtime.job import Job
from yarclang.toml.places import find_places
from yarclang.ways import Turn, Ways


@frozen(eq=False)
class Listed:
    """A job of a project: its number, its file, its compiled program (None if it has errors), and its
    findings.
    """

    number: int
    file: str
    job: Job | None
    diagnostics: tuple[Diagnostic, ...]


def listed_jobs(project: Project, options: Options) -> Iterator[Listed]:
    """Compile and prove the jobs of a project, in the order of their numbers.

    Each job must begin and end where the first job begins, so that any job may follow any other.

    Args:
        project: settings of a yarc.toml that lists jobs.
        options: the user's options, for all jobs.
    """
    first: tuple[int, Job] | None = None
    for number, file in sorted(project.jobs.items()):
        tell("jobs", number)
        path = Path(file) if Path(file).is_absolute() else project.folder / file
        opened = open_program(str(path), options)
        if opened.value is None:
            yield Listed(number, file, None, opened.diagnostics)
            continue
        compiled = compile_module(opened.value.module, opened.value.request)
        diagnostics = (*opened.diagnostics, *compiled.diagnostics)
        if compiled.value is None or has_errors(diagnostics):
            yield Listed(number, file, None, diagnostics)
            continue
        job = job_of_compiled(compiled.value, path.name)
        first = first or (number, job)
        diagnostics = (*diagnostics, *_apart(project, number, job, _ends(compiled.value), first))
        yield Listed(number, file, None if has_errors(diagnostics) else job, diagnostics)


def _ends(compiled: Compiled) -> list[Array]:
    """Return the joint positions (n,) [rad or m] at which a program may end: after its last line, and at each
    STOP in a branch.
    """
    stands = {motion.step: motion.path.end for motion in compiled.plan.motions}
    walked = Ways(compiled.program.start)
    ends: list[Array] = []
    for number, step in enumerate(compiled.program.steps):
        if isinstance(step, Finish) and not (step.fails or walked.ends):
            ends.append(walked.state)
        if isinstance(step, Turn):
            walked = walked.turned(step, lambda first, _, __: first)
        elif number in stands and not walked.ends:
            walked = replace(walked, state=stands[number])
    return ends if walked.ends else [*ends, walked.state]


def _apart(
    project: Project, number: int, job: Job, ends: list[Array], first: tuple[int, Job]
) -> Iterator[Diagnostic]:
    """Yield findings if a job has another robot or another start than the first job, or doesn't end at
    this start.
    """
    other, common = first
    if job.robot.folder != common.robot.folder:
        message = f"job {number} is for {job.robot.name}, job {other} for {common.robot.name}"
        yield _finding(project, number, message, "use one robot for all jobs of a project")
        return
    for word, place in (("begins", job.start), *(("ends", end) for end in ends)):
        off = np.abs(place - common.start)
        if (off <= job.slack).all():
            continue
        joint = int(np.argmax(off / job.slack))
        names, units = job.robot.joint_names, job.robot.axis_unit_names
        here, there = (_value(job, one, joint) for one in (place, common.start))
        message = (
            f"job {number} {word} with {names[joint]} at {here} {units[joint]}, but job {other} begins at "
            f"{there} {units[joint]}"
        )
        help_ = "give all programs the same START" if word == "begins" else "end it with a MOVEJ to its START"
        yield _finding(project, number, message, help_)


def _value(job: Job, q: Array, joint: int) -> str:
    return f"{q[joint] / job.robot.axis_units[joint] + 0.0:.6g}"


def _finding(project: Project, number: int, message: str, help_: str) -> Diagnostic:
    source = project.source
    span = None if source is None else find_places(source).of_key(("jobs", str(number)))
    return Diagnostic("Y1395", message, source, span, help_)
