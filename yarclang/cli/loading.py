"""A program's file to what can be run."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import click

from yarclang.cell.model import Cell
from yarclang.certify.judge import certify_text
from yarclang.cli.outputs import STANDARD
from yarclang.cli.work import Progress, options_from
from yarclang.coordinator.programs import Loaded, load_program
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.pipeline.cells import cell_loader
from yarclang.pipeline.checking import check_program_file
from yarclang.pipeline.jobs import Papers, job_of_text
from yarclang.pipeline.origins import Origins, origins_of_text
from yarclang.pipeline.sources import read_source
from yarclang.robot.description import load_robot
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span

_COMPILED = ".pmc"
_FIRST_WORDS = "; yarcc "
_AGAIN = "it isn't as yarcc wrote it: compile the program again"


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

    Raises:
        click.UsageError: an option doesn't go with the file.
    """
    if options.get("cell") is not None and not is_compiled(file):
        raise click.UsageError("--cell: only with a .pmc; a program names its cell itself, in a CELL line")
    result = _compiled_before(file, options) if is_compiled(file) else _compile(file, first, options)
    return (None if has_errors(result.diagnostics) else result.value), in_order(result.diagnostics)


def _compiled_before(file: str, options: dict[str, Any]) -> Result[Loaded]:
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
    robot = robot_of_text(source, options["robot"])
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
    origins = cache(partial(origins_of_text, source.text, Path(file).parent, robot.value))
    around = _around(source, robot.value, origins, options)
    diagnostics = (*diagnostics, *around.diagnostics)
    if has_errors(diagnostics):
        return Result(None, diagnostics)
    return Result(Loaded(job, job, origins=origins, cell=around.value), diagnostics)


def _around(
    source: SourceFile, robot: Robot, origins: Callable[[], Origins], options: dict[str, Any]
) -> Result[Cell]:
    """The cell that an approach to the start of a controller text is planned in: that of --cell, else its program's."""
    if options.get("cell") is not None:
        return cell_loader(Path(), robot)(options["cell"], None)
    if not options.get("approach"):
        return Result(None)
    found = origins()
    if found.program is not None:
        return Result(found.program.cell)
    message = f"the approach is planned without a cell: {found.missing}"
    help_ = "look that the straight way is free; or --cell FILE.toml says what is around"
    return Result(None, (Diagnostic("Y0927", message, source, help=help_),))


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
        checked = check_program_file(file, options_from(options, progress))
        if checked.opened is None or checked.compiled is None:
            return Result(None, checked.diagnostics)
        name = "stdin" if file == STANDARD else Path(file).name
        compiled = Result(checked.compiled, checked.diagnostics)
        return load_program(checked.opened, name, first, by_steps=options["step"], compiled=compiled)
