"""Texts of robot.toml, cell.toml or a program into which the result of a calibration has been put. Each
text is checked by reading it with the ordinary reader of its file.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from yarclang.calibration.cell_frames import (
    CellFrameError,
    moves_text,
    read_frame_cell,
    with_measured_frame,
)
from yarclang.calibration.touching import FrameTouching, HomeTouching, TipTouching, Touching
from yarclang.calibration.writing import with_offsets, with_tip
from yarclang.cell.description import Names
from yarclang.diagnostics import Diagnostic
from yarclang.robot.description import read_robot
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.semantics.declared.meanings import is_word
from yarclang.source import SourceFile
from yarclang.teaching.declaring import declare_pose
from yarclang.teaching.edits import Program, applied
from yarclang.teaching.holding import around
from yarclang.toml.changes import ChangeError

RESTART = "restart the pendant (System > Controller): until then it uses the previous description"
SETTINGS = f"{RESTART}, then send the settings to the controller again"
CELL = "the coordinator reads the cell again by itself; programs that are loaded have to be loaded again"
PROGRAM = "load the program again"

_NEAR = 5e-6
"""Largest rounding error of a pose that is accepted when the changed text is read back. It applies to the
position [m], and to the entries of the rotation matrix.
"""
_OFFSET = 0.006
"""Largest rounding error of motor offsets that is accepted when the changed text is read back [counts]."""


@dataclass(frozen=True, slots=True)
class Made:
    """The text of a file into which the result of a calibration has been put.

    Attributes:
        text: text of the whole file.
        what: description of the change.
        then: what the user must do so that the change takes effect, in words.
        findings: findings of the reader of the file in the changed text.
    """

    text: str
    what: str
    then: str
    findings: tuple[Diagnostic, ...]


def in_robot(source: SourceFile, place: Path, robot: Robot, touching: Touching, *, replace: bool) -> Made:
    """Return the text of robot.toml with the calibrated tip of a tool or offsets of motors.

    Args:
        source: present text of robot.toml.
        place: path of robot.toml.
        robot: robot as the pendant loaded it at its start.
        touching: recorded positions, and the result that follows from them.
        replace: True if an existing frame of the same name may be replaced.

    Raises:
        Trouble: the result can't be put into this text.
    """
    before = read_robot(source, place.parent)
    if before.value is None:
        first = before.diagnostics[0]
        raise Trouble(f"{place.name} can't be read: {first.message}", first.help, first.code)
    if isinstance(touching, HomeTouching):
        return _offsets(source, place, (robot, before.value), touching)
    if not isinstance(touching, TipTouching) or touching.value is None:
        raise Trouble(
            "a frame isn't written into the robot's file", "write it into the cell or a program", "to"
        )
    name, tip = touching.name, touching.value.flange_from_tip
    old = before.value.flange_from_frame.get(name)
    if old is not None and not replace:
        raise _exists(
            f"{{{name}}} is a frame of {before.value.name} already",
            "its tip changes, its orientation doesn't",
        )
    key, local = name, tip
    tables = tomllib.loads(source.text).get("frames", {})
    if old is not None:
        key = next((one for one in tables if one.upper() == name), name)
        parent = before.value.flange_from_frame[str(tables.get(key, {}).get("parent", "FLANGE")).upper()]
        local = parent[:3, :3].T @ (tip - parent[:3, 3])
    hanging = sorted(
        one.upper() for one, table in tables.items() if str(table.get("parent", "")).upper() == name
    )
    text = _changed(lambda: with_tip(source, key, local), place.name)
    after = read_robot(SourceFile(source.name, text), place.parent)
    new_offsets = np.eye(4) if old is None else old.copy()
    new_offsets[:3, 3] = tip
    _check_pose(
        None if after.value is None else after.value.flange_from_frame.get(name),
        new_offsets,
        after.diagnostics,
    )
    description = (
        f"the tip {{{name}}} is written, in the orientation of the flange"
        if old is None
        else moves_text(name, old, new_offsets)
    )
    if hanging:
        description += f"; {', '.join(f'{{{one}}}' for one in hanging)} are attached to it, and move with it"
    return Made(text, description, RESTART, after.diagnostics)


def _offsets(source: SourceFile, place: Path, robots: tuple[Robot, Robot], touching: HomeTouching) -> Made:
    assert touching.value is not None  # the caller has checked it
    robot, on_disk = robots
    known, there = robot.actuation.offset, on_disk.actuation.offset
    if known.shape != there.shape or np.abs(known - there).max() > _OFFSET:
        what = f"the offsets in {place.name} have changed since the pendant was started"
        raise Trouble(what, "restart the pendant (System > Controller), and touch again", "stale")
    offsets = touching.value.offsets
    text = _changed(lambda: with_offsets(source, offsets), place.name)
    after = read_robot(SourceFile(source.name, text), place.parent)
    if after.value is None or np.abs(after.value.actuation.offset - offsets).max() > _OFFSET:
        raise _lost(after.diagnostics)
    return Made(text, "; ".join(touching.result_text().splitlines()), SETTINGS, after.diagnostics)


def in_cell(
    source: SourceFile, place: Path, robot: Robot, touching: Touching, parent: str, *, replace: bool
) -> Made:
    """Return the text of cell.toml with the calibrated frame. A frame that exists already keeps its parent.

    Args:
        source: present text of cell.toml.
        place: path of cell.toml.
        robot: robot of the cell.
        touching: recorded positions, and the result that follows from them.
        parent: frame in which a new frame is declared: one of the cell's stationary frames, or B.
        replace: True if an existing frame of the same name may be replaced.

    Raises:
        Trouble: the result can't be put into this text.
    """
    if not isinstance(touching, FrameTouching) or touching.value is None:
        raise Trouble(
            "only a frame can be written into a cell", "write it into the robot's file or a program", "to"
        )
    names, name = Names(is_word, robot), touching.name
    try:
        exists = name in read_frame_cell(source, place, names).frames
        if exists and not replace:
            raise _exists(
                f"{{{name}}} is a frame of {place.name} already", "it gets another place and orientation"
            )
        made = with_measured_frame(source, place, names, name, touching.value.base_from_frame, parent)
    except CellFrameError as error:
        raise Trouble(str(error), error.help, error.what) from None
    return Made(made.text, made.what, CELL, made.findings)


def in_program(source: SourceFile, place: Path, robot: Robot, touching: Touching, *, replace: bool) -> Made:
    """Return the text of a program with a FRAME line for the calibrated frame among its declarations.

    Args:
        source: present text of the program.
        place: path of the program.
        robot: robot of the program.
        touching: recorded positions, and the result that follows from them.
        replace: True if an existing FRAME line for the same name may be replaced.

    Raises:
        Trouble: the result can't be put into this text.
    """
    pose, parent = np.eye(4), "FLANGE"
    if isinstance(touching, TipTouching) and touching.value is not None:
        pose[:3, 3] = touching.value.flange_from_tip
    elif isinstance(touching, FrameTouching) and touching.value is not None:
        pose, parent = np.array(touching.value.base_from_frame), "B"
    else:
        raise Trouble("offsets aren't written into a program", "write them into the robot's file", "to")
    name = touching.name
    named = around(Program(source), place.parent, robot)
    declared = named.program.sketch.names.declared(name, True)
    old = None if declared is None else named.scope.frame(name)
    if declared is not None and not replace:
        raise _exists(
            f"{{{name}}} is declared in line {declared.span.line} already", "the line gets other values"
        )
    new_text = declare_pose(named, name, pose, parent, again=replace)
    text = applied(source.text, new_text.edits)
    after = around(Program(SourceFile(source.name, text)), place.parent, robot)
    found = after.scope.frame(name)
    _check_pose(None if found is None else np.array(found.transform), pose, ())
    what = (
        new_text.what
        if old is None
        else f"{new_text.what}; {moves_text(name, np.array(old.transform), pose)}"
    )
    return Made(text, what, PROGRAM, ())


def _changed(change: Callable[[], str], name: str) -> str:
    try:
        return change()
    except ChangeError as error:
        what = f"{name} is written in a form that can't be changed here: {error}"
        raise Trouble(
            what, "give the frame a table [frames.NAME] of its own, or change the file by hand", "form"
        ) from None


def _check_pose(present: Array | None, expected: Array, findings: tuple[Diagnostic, ...]) -> None:
    if present is None or np.abs(present - expected).max() > _NEAR:
        raise _lost(findings)


def _lost(findings: tuple[Diagnostic, ...]) -> Trouble:
    said = f": {findings[0].message}" if findings else ""
    what = f"the written file would differ from the calibration{said}"
    return Trouble(what, "change the file by hand; nothing was written", "form")


def _exists(subject: str, remedy: str) -> Trouble:
    return Trouble(subject, f"replace it ({remedy}), or choose another name", "exists")
