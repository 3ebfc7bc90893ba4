"""Load a program's file for a run, with progress."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from yarclang.cli.outputs import STANDARD
from yarclang.cli.work import Progress, options_from
from yarclang.coordinator.loading import Source
from yarclang.coordinator.loading import load as load_source
from yarclang.coordinator.messages import orders
from yarclang.coordinator.programs import Loaded
from yarclang.diagnostics import Diagnostic
from yarclang.pipeline.controller_text import is_compiled, read_controller_text, robot_of_text
from yarclang.pipeline.inputs import open_program, robot_for
from yarclang.robot.model import Robot

Found = tuple[Diagnostic, ...]


def source_of(file: str, first: str | None, options: dict[str, Any]) -> Source:
    """Return the program that a command line selects to be run.

    Args:
        file: a .yarc or .pmc file.
        first: index of the first command; None for the whole program.
        options: options of the command line.

    Raises:
        click.UsageError: an option isn't allowed for the file.
    """
    if options.get("source") is not None and not is_compiled(file):
        raise click.UsageError("--source can be used only with a .pmc: it names its program")
    return Source(
        file,
        None,
        first,
        bool(options.get("step")),
        options_from(options),
        options.get("source"),
        bool(options.get("approach") or options.get("recover")),
    )


def load(source: Source) -> tuple[Loaded | None, Found]:
    """Compile a program, or read and check a compiled one.

    Returns:
        The program (None if an error prevents a run), and all findings.
    """
    with Progress():
        made = load_source(source)
    return made.value, made.diagnostics


def load_order(source: Source, *, recover: bool = False) -> orders.Load:
    """Return the order by which the coordinator loads a program: to run it or, with `recover`, only to move
    the robot to its start. Standard input is read here.
    """

    def absolute(path: str | None) -> str | None:
        return None if path is None else str(Path(path).absolute())

    text = None
    if source.file == STANDARD:
        text = sys.stdin.buffer.read().decode("utf-8", "replace")
    options = source.options
    tolerance = options.tolerance
    return orders.Load(
        file=str(Path("stdin" if text is not None else source.file).absolute()),
        text=text,
        first=source.first,
        by_steps=source.by_steps,
        start=options.start,
        tolerance=None if tolerance is None else tuple(one for one in tolerance if one is not None),
        tm=options.tm,
        cell=absolute(options.cell),
        source=absolute(source.program),
        approach=source.approach,
        recover=recover,
    )


def robot_of(source: Source) -> Robot | None:
    """Return the robot of a program, without compiling the program; None if it isn't known, as for
    standard input.
    """
    if source.options.robot is not None:
        return robot_for(Path(), source.options.robot).value
    if source.is_compiled:
        read = read_controller_text(source.file)
        return None if read.value is None else robot_of_text(read.value, None).value
    if source.file == STANDARD:
        return robot_for(Path(), None).value
    opened = open_program(source.file, source.options)
    return None if opened.value is None else opened.value.request.robot
