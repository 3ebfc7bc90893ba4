"""Open a program, a controller text or the log of a run as a scene."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from yarclang.diagnostics import Result
from yarclang.pipeline.checking import check_text, settled_in_folder
from yarclang.pipeline.inputs import Options, open_source
from yarclang.pipeline.sources import LARGEST_DATA, STANDARD_INPUT, read_source
from yarclang.pipeline.stages import shown_plan
from yarclang.report.runs.kind import is_log
from yarclang.robot.model import Robot
from yarclang.source import SourceFile
from yarclang.view.of_program import stage_of_program
from yarclang.view.partial import met
from yarclang.view.stage import Stage

_COMPILED = "; yarcc "


RobotOf = Callable[[SourceFile, str | None], Result[Robot]]
"""Function that finds the robot of a controller text. Its arguments are the text and the name on the command
line.
"""


def opened(file: str, options: Options, robot_of: RobotOf) -> Result[Stage]:
    """Return the scene of a file: a program, a controller text, or the log of a run. `-` is standard input.

    Returns:
        None, with findings, if there is nothing to show.
    """
    if file != STANDARD_INPUT and is_log(file):
        from yarclang.view.of_run import stage_of_run

        return stage_of_run(file, options.robot, options.cell)
    read = read_source(file, LARGEST_DATA)
    if read.value is None:
        return Result(None, read.diagnostics)
    folder = Path.cwd() if file == STANDARD_INPUT else Path(file).parent
    if read.value.text.startswith(_COMPILED):
        from yarclang.view.of_text import stage_of_text

        robot = robot_of(read.value, options.robot)
        if robot.value is None:
            return Result(None, robot.diagnostics)
        made = stage_of_text(read.value, folder, robot.value, options.cell)
        return Result(made.value, (*robot.diagnostics, *made.diagnostics))
    return program_stage(read.value, folder, options)


def program_stage(source: SourceFile, folder: Path, options: Options) -> Result[Stage]:
    """Return the scene of a program in a folder; None, with findings, if the program's robot isn't known."""
    checked = check_text(source, folder, options)
    found = checked.diagnostics
    if checked.program is None:
        return Result(None, found)
    plan = checked.plan
    if plan is None:
        again = open_source(source, folder, options).value
        assert again is not None  # it was opened before it was checked
        plan = shown_plan(checked.program, again.request)
        if plan is None:
            return Result(None, found)
    if checked.compiled is None:
        said = {(one.code, one.made_at[1], one.place) for one in found}
        more = [one for one in met(plan) if (one.code, one.span, one.place) not in said]
        found = settled_in_folder((*found, *more), source, folder, checked.opened)
    certificate = checked.compiled.certificate if checked.compiled is not None else None
    return Result(stage_of_program(source.name, plan, certificate, found), found)
