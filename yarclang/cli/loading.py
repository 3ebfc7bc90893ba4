"""A program's file to what can be run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from yarclang.cli.outputs import STANDARD
from yarclang.cli.work import Progress, options_from
from yarclang.coordinator.programs import Loaded, load_program
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.pipeline.checking import check_program_file
from yarclang.pipeline.controller_text import COMPILED, judge_text, read_controller_text
from yarclang.pipeline.jobs import Papers, job_of
from yarclang.pipeline.origins import Origins

Found = tuple[Diagnostic, ...]


def is_compiled(file: str) -> bool:
    """Whether a file is called as what yarcc writes."""
    return file.lower().endswith(COMPILED)


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
    if options.get("source") is not None and not is_compiled(file):
        raise click.UsageError("--source: only with a .pmc, which it is the program of")
    result = _compiled_before(file, options) if is_compiled(file) else _compile(file, first, options)
    return (None if has_errors(result.diagnostics) else result.value), in_order(result.diagnostics)


def _compiled_before(file: str, options: dict[str, Any]) -> Result[Loaded]:
    """A .pmc file, judged against the program beside it."""
    read = read_controller_text(file)
    if read.value is None:
        return Result(None, read.diagnostics)
    with Progress():
        made = judge_text(
            read.value,
            Path(file).parent,
            options_from(options),
            options.get("source"),
        )
    judged = made.value
    if judged is None:
        return Result(None, made.diagnostics)
    diagnostics = made.diagnostics
    source = "" if judged.program is None else judged.program.source.text
    papers = Papers(source, json.dumps(judged.certificate.to_json()))
    job = job_of(judged.certificate, judged.text.text, judged.robot, Path(file).name, papers)
    if job.value is None:
        return Result(None, job.diagnostics)
    if options.get("approach") and judged.cell is None and judged.program is None:
        message = f"the approach is planned without a cell: {judged.missing}"
        help_ = "look that the straight way is free; or --cell FILE.toml says what is around"
        diagnostics = (*diagnostics, Diagnostic("Y0927", message, judged.text, help=help_))
    origins = Origins(judged.program, judged.missing)
    return Result(Loaded(job.value, job.value, origins=lambda: origins, cell=judged.cell), diagnostics)


def _compile(file: str, first: str | None, options: dict[str, Any]) -> Result[Loaded]:
    with Progress():
        checked = check_program_file(file, options_from(options))
        if checked.opened is None or checked.compiled is None:
            return Result(None, checked.diagnostics)
        name = "stdin" if file == STANDARD else Path(file).name
        compiled = Result(checked.compiled, checked.diagnostics)
        return load_program(checked.opened, name, first, by_steps=options["step"], compiled=compiled)
