"""The program that a session works with: a file, its declarations, its commands."""

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
"""Declarations that a session has no use for: its robot is there, and stands where it stands."""


@dataclass(frozen=True, slots=True, eq=False)
class LoadedFile:
    """A program's file as it was read: its top-level `declarations` as they are written, and the indices of its `commands`."""

    path: Path
    module: Module
    declarations: tuple[str, ...]
    commands: tuple[str, ...]


def load_file(path: Path, robot: Robot, stands: Array, cell: str | None) -> Result[LoadedFile]:
    """Read and check a program.

    Args:
        path: of the file.
        robot: that it must be for.
        stands: (n,) where it begins unless it says START [rad or m].
        cell: the path of the cell.toml that the session keeps to, and the program with it.

    Returns:
        None where a finding forbids to work with it; what only planning tells isn't asked here.
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
