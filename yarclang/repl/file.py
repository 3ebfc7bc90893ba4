"""The program of a session: a file, its declarations and its commands."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from yarclang.coordinator.lines import parts_of
from yarclang.coordinator.loading import Source, open_here
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.pipeline.inputs import Options
from yarclang.pipeline.stages import check_program
from yarclang.robot.model import Array, Robot
from yarclang.syntax.ast import Module

_OF_FILES = ("ROBOT", "START")
"""Declarations that a session ignores, since its robot is connected and has a position already."""


@dataclass(frozen=True, slots=True, eq=False)
class LoadedFile:
    """A program's file that the session has loaded.

    Attributes:
        path: the file.
        module: syntax tree of the program.
        declarations: top-level declarations of the program, as they are written.
        commands: indices of the commands.
    """

    path: Path
    module: Module
    declarations: tuple[str, ...]
    commands: tuple[str, ...]


def load_file(path: Path, robot: Robot, stands: Array, cell: str | None) -> Result[LoadedFile]:
    """Read and check a program. Its motions aren't planned.

    Args:
        path: the file.
        robot: the robot for which the program must be written.
        stands: (n,) start position of a program without a START line [rad or m].
        cell: path of the cell.toml of session and program.

    Returns:
        The loaded program; None, with findings, if an error prevents its use.
    """
    opened = open_here(Source(str(path), options=Options(robot=str(robot.folder), cell=cell)), stands)
    if opened.value is None:
        return Result(None, opened.diagnostics)
    module = opened.value.module
    checked = check_program(module, opened.value.request)
    found: tuple[Diagnostic, ...] = (*opened.diagnostics, *checked.diagnostics)
    if has_errors(found):
        return Result(None, found)
    parts = parts_of(module)
    kept = tuple(one for one in parts.declarations if one.split(maxsplit=1)[0].upper() not in _OF_FILES)
    commands = tuple(one.index.name for one in module.statements if one.index is not None)
    return Result(LoadedFile(path, module, kept, commands), found)
