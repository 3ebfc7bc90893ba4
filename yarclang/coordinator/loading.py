"""Loading of a program so that it can be run, from a file or a text. Files are read; nothing moves."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from yarclang.coordinator.programs import Loaded, behind_search, load_program, ways_out
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.handling.parts import first_parts
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.checking import check_program_file, check_text
from yarclang.pipeline.controller_text import is_compiled, judge_text, read_controller_text
from yarclang.pipeline.inputs import Opened, Options, open_program, open_source
from yarclang.pipeline.jobs import job_of
from yarclang.pipeline.origins import Origins
from yarclang.pipeline.sources import STANDARD_INPUT
from yarclang.pipeline.stages import CellNow, Request
from yarclang.robot.description import load_robot
from yarclang.robot.model import Array, Robot
from yarclang.runtime.job import Papers
from yarclang.source import SourceFile


@dataclass(frozen=True, slots=True)
class Source:
    """The program to be run, and the options with which it is compiled.

    Attributes:
        file: path of the program; `-` for the standard input.
        text: text that is used instead of the file's; None: the file's text.
        first: index of the command with which the run begins; None: the first command.
        by_steps: True if the commands are run one by one.
        options: robot, start, tolerance, segment time, cell.
        program: for a compiled program, the path of the source against which it is verified; None: the source
            file in the same folder.
        approach: True to prepare also the motion to the program's start.
        present: returns the cell with its parts at their present places; None: the parts are in the places
            that the program assumes.
    """

    file: str
    text: str | None = None
    first: str | None = None
    by_steps: bool = False
    options: Options = field(default_factory=Options)
    program: str | None = None
    approach: bool = False
    present: CellNow | None = None

    @property
    def is_compiled(self) -> bool:
        """Return True if the file name has the ending that yarcc gives to compiled programs."""
        return is_compiled(self.file)

    @property
    def name(self) -> str:
        """Return the name of the program, for messages."""
        return "stdin" if self.file == STANDARD_INPUT else Path(self.file).name


def load(source: Source, robot: Robot | None = None, stands: Array | None = None) -> Result[Loaded]:
    """Compile a program, or verify a compiled program again.

    Args:
        source: the program.
        robot: robot that the program must be written for; None: the robot that the program or the options
            name.
        stands: (n,) joint positions at which a program without START begins [rad or m]; None: as the options
            and the project specify.

    Returns:
        The program and all findings in order; no program if an error forbids running it.
    """
    if robot is not None:
        source = replace(source, options=replace(source.options, robot=str(robot.folder)))
    original = source
    if source.first is None and not source.is_compiled:
        source = replace(source, options=replace(source.options, present=source.present))
    if source.is_compiled:
        result = _judged(source)
    elif stands is None:
        result = _compiled(source)
    else:
        result = _compiled_here(source, stands)
    if robot is not None and (found := _changed(robot, result.value)) is not None:
        return Result(None, (found,))
    loaded = None if has_errors(result.diagnostics) else result.value
    if loaded is not None and loaded.plan is not None and loaded.assumed is not None:
        loaded = replace(loaded, again=_again(original, loaded.plan, robot, stands))
    return Result(loaded, in_order(result.diagnostics))


def _changed(robot: Robot, loaded: Loaded | None) -> Diagnostic | None:
    """Return a finding if the files of the robot's description have changed since the coordinator read them;
    otherwise None. A proof with the new description isn't valid for a coordinator that uses the old one.
    """
    if loaded is not None and loaded.program.robot.fingerprint == robot.fingerprint:
        return None
    present = load_robot(str(robot.folder)).value if loaded is None else None
    if present is not None and present.fingerprint == robot.fingerprint:
        return None
    message = f"robot.toml or the URDF of {robot.name} has changed since the robot was served"
    return Diagnostic("Y1392", message, help="restart the process that serves it, or undo the change")


def _again(
    source: Source, plan: MotionPlan, robot: Robot | None, stands: Array | None
) -> Callable[[CellNow], Result[Loaded]]:
    """Return a function that compiles the program again for other places of the cell's parts. It uses the
    text of the program that was read before, even if the file has changed.
    """
    whole = replace(source, text=plan.program.source.text, first=None, by_steps=False)

    def again(present: CellNow) -> Result[Loaded]:
        return load(replace(whole, present=present), robot, stands)

    return again


def _judged(source: Source) -> Result[Loaded]:
    """Verify a compiled program against its source file."""
    read = read_controller_text(source.file)
    if read.value is None:
        return Result(None, read.diagnostics)
    made = judge_text(read.value, Path(source.file).parent, source.options, source.program)
    judged = made.value
    if judged is None:
        return Result(None, made.diagnostics)
    diagnostics = made.diagnostics
    text = "" if judged.program is None else judged.program.source.text
    papers = Papers(text, json.dumps(judged.certificate.to_json()))
    job = job_of(judged.certificate, judged.text.text, judged.robot, source.name, papers)
    if job.value is None:
        return Result(None, job.diagnostics)
    if source.approach and judged.cell is None and judged.program is None:
        message = f"the approach is planned without a cell, {judged.missing}"
        help_ = "check that the straight path is free, or give the cell with --cell FILE.toml"
        diagnostics = (*diagnostics, Diagnostic("Y0927", message, judged.text, help=help_))
    origins = Origins(judged.program, judged.missing)
    cell = judged.cell
    assumed = first_parts(cell) if cell is not None and cell.parts else None
    loaded = Loaded(
        job.value,
        job.value,
        origins=lambda: origins,
        cell=cell,
        assumed=assumed,
        text_plan=judged.plan,
        behind=None if judged.plan is None else behind_search(judged.plan, Request(judged.robot)),
        leave=None if judged.plan is None else ways_out(judged.plan, Request(judged.robot)),
    )
    return Result(loaded, diagnostics)


def _compiled(source: Source) -> Result[Loaded]:
    if source.text is None:
        checked = check_program_file(source.file, source.options)
    else:
        checked = check_text(SourceFile(source.file, source.text), _folder(source), source.options)
    if checked.opened is None or checked.compiled is None:
        return Result(None, checked.diagnostics)
    compiled = Result(checked.compiled, checked.diagnostics)
    return load_program(
        checked.opened,
        source.name,
        source.first,
        by_steps=source.by_steps,
        compiled=compiled,
        present=source.present,
    )


def _compiled_here(source: Source, stands: Array) -> Result[Loaded]:
    opened = open_here(source, stands)
    if opened.value is None:
        return Result(None, opened.diagnostics)
    made = load_program(
        opened.value, source.name, source.first, by_steps=source.by_steps, present=source.present
    )
    return Result(made.value, (*opened.diagnostics, *made.diagnostics))


def open_here(source: Source, stands: Array) -> Result[Opened]:
    """Read and parse a program. Unless it contains a START, it begins at the robot's present position.

    Args:
        source: the program.
        stands: (n,) position of the robot [rad or m].
    """
    if source.text is None:
        opened = open_program(source.file, source.options)
    else:
        opened = open_source(SourceFile(source.file, source.text), _folder(source), source.options)
    if opened.value is None or has_errors(opened.diagnostics):
        return Result(None, opened.diagnostics)
    request = opened.value.request
    if request.fallback_start is None:
        request = replace(request, fallback_start=stands)
    return Result(replace(opened.value, request=request), opened.diagnostics)


def _folder(source: Source) -> Path:
    return Path.cwd() if source.file == STANDARD_INPUT else Path(source.file).parent
