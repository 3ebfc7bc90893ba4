"""Create the files of a new project from the standard library's folder `project`, with a name and a robot
filled in.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from yarclang.diagnostics import Diagnostic
from yarclang.files import reason_of
from yarclang.pipeline.modules import SUFFIX, library_folder
from yarclang.robot.library import stdlib_folder
from yarclang.robot.model import Robot

CHECK = "check.sh"
_FILES = {
    "program.yarc": "@NAME@.yarc",
    "cell.toml": "cell.toml",
    "yarc.toml": "yarc.toml",
    "README.md": "README.md",
    "check.sh": CHECK,
    "gitignore": ".gitignore",
    "editorconfig": ".editorconfig",
    "vscode_settings.json": ".vscode/settings.json",
    "vscode_tasks.json": ".vscode/tasks.json",
}
"""Destination of each file of the template."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,59}")
_STEP = {"deg": 5.0, "mm": 50.0}
"""Distance that the first joint moves in the first program."""


def check_name(name: str) -> tuple[Diagnostic, ...]:
    """Return a finding if a project can't have this name."""
    help_ = "use letters A to Z, digits, _ and -, a letter first, at most 60 characters: yarc new first_cell"
    if not _NAME.fullmatch(name):
        return (Diagnostic("Y1522", f"{name[:80]!r} can't be the name of a project", help=help_),)
    if (library_folder() / f"{name.lower()}{SUFFIX}").is_file():
        message = (
            f"{name} is the name of a module of the standard library, which a program of this name would hide"
        )
        return (Diagnostic("Y1522", message, help="choose another name"),)
    return ()


def check_folder(folder: Path) -> tuple[Diagnostic, ...]:
    """Return a finding if a folder already contains files that would get mixed with those of a new
    project.
    """
    try:
        if folder.is_dir():
            there = sorted(path.name for path in folder.iterdir())
            if not there:
                return ()
            shown = ", ".join(there[:3]) + ", ..." * (len(there) > 3)
            message = f"{folder} exists and contains {shown}"
        elif folder.exists() or folder.is_symlink():
            message = f"{folder} exists, but isn't a folder"
        else:
            return ()
    except OSError as error:
        message = f"{folder} can't be read: {reason_of(error)}"
    return (Diagnostic("Y1521", message, help="choose another name or another folder"),)


def project_files(name: str, robot: Robot, robot_entry: str) -> dict[str, str]:
    """Return the texts of a new project's files, by their paths relative to the project's folder.

    Args:
        name: name of the project and its program.
        robot: robot of its program.
        robot_entry: the robot's name, or its path relative to the project's folder.
    """
    joint, unit = 0, robot.axis_unit_names[0]
    up, down = (robot.limits.upper - robot.home)[joint], (robot.home - robot.limits.lower)[joint]
    # Move at most half of the way from the home position to the joint's limit.
    step = min(_STEP[unit], max(up, down) / 2 / robot.axis_units[joint]) * (1 if up >= down else -1)
    filled = {
        "@NAME@": name,
        "@ROBOT@": json.dumps(robot_entry, ensure_ascii=False),
        "@ROBOT_NAME@": robot.name,
        "@FRAME@": "TCP" if "TCP" in robot.flange_from_frame else "FLANGE",
        "@STEP@": " ".join([f"{step:.6g}", *["0"] * (robot.size - 1)]),
    }
    files: dict[str, str] = {}
    for template, place in _FILES.items():
        text = (stdlib_folder() / "project" / template).read_text(encoding="utf-8")
        for mark, value in filled.items():
            text, place = text.replace(mark, value), place.replace(mark, value)  # noqa: PLW2901
        files[place] = text
    return files
