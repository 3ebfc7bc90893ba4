"""Compile files."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from yarclang.cli.door import failure_of, is_failure
from yarclang.cli.fleet import Fleet, ended
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.outputs import STANDARD, beside
from yarclang.cli.paths import programs
from yarclang.findings import YARCLANG

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.inputs import Options
    from yarclang.pipeline.stages import Compiled


@dataclass(frozen=True, slots=True)
class Task:
    """Settings of yarcc that apply to each file.

    Attributes:
        options: options of the command line.
        strict: True if a warning counts as an error.
        with_proof: True if the proof for `yarc verify` is wanted.
    """

    options: Options
    strict: bool = False
    with_proof: bool = False


@dataclass(frozen=True, slots=True)
class Made:
    """Result of yarcc for a file.

    Attributes:
        compiled: the compiled program; None if there is nothing to write.
        found: findings.
        proof: the text of the proof, if it is wanted and there is one.
    """

    compiled: Compiled | None
    found: tuple[Diagnostic, ...]
    proof: str | None = None


def compile_all(files: Sequence[str], task: Task, fleet: Fleet) -> Iterator[Made]:
    """Compile files, and yield the results in the order of the files."""
    return fleet.results(
        partial(compile_one, task=task),
        files,
        name=lambda path: ("compile", path, task.options.said, task.strict, task.with_proof),
        is_lasting=lambda made: not any(one.family == YARCLANG for one in made.found),
        lost=lambda path, why: Made(None, (ended(path, why),)),
    )


def compile_one(path: str, task: Task) -> Made:
    """Compile one file. An exception becomes a finding."""
    try:
        return _compiled(path, task)
    except Exception as error:
        if not is_failure(error):
            raise
        return Made(None, (failure_of(error, path),))  # a bug of ours: continue with the other files


def _compiled(path: str, task: Task) -> Made:
    seldom_look_for_garbage()  # in each process that compiles files
    from yarclang.pipeline.checking import check_program_file

    checked = check_program_file(path, task.options)
    compiled, found = checked.compiled, checked.diagnostics
    if compiled is None or (task.strict and any(one.severity == "warning" for one in found)):
        return Made(None, found)
    if not task.with_proof:
        return Made(compiled, found)
    from yarclang.pipeline.proofs import proof_of

    proof = proof_of(compiled)
    return Made(compiled, (*found, *proof.diagnostics), proof.value)


def destinations_of(
    paths: Sequence[str], output: str | None, folder: Path | None, suffix: str = ".pmc"
) -> dict[str, str]:
    """Return the path of the output file (the controller text or a picture) for each program.

    Args:
        paths: programs, and folders of programs.
        output: path of the output file if there is one program.
        folder: folder for the output files; programs of a folder keep their subfolders there. None writes
            output files beside the programs. Each program must then be named, so that a typing mistake
            doesn't fill folders with files.
        suffix: suffix of the output files.

    Raises:
        click.UsageError: a folder has no program, or `folder` is missing for the programs of a folder.
    """
    found: dict[str, str] = {}
    what = "texts" if suffix == ".pmc" else "pictures"
    for path in paths:
        inside = path not in ("", STANDARD) and os.path.isdir(path)  # noqa: PTH112 (Path.is_dir raises where a folder can't be searched)
        if inside and folder is None:
            raise click.UsageError(
                f"{path} is a folder: give the folder for the {what} of its programs with --out-dir"
            )
        for file in programs([path]) if inside else [path]:
            where = folder / os.path.relpath(Path(file).parent, path) if inside and folder else folder
            found.setdefault(file, output or beside(file, suffix, where))
    return found
