"""Write a frame's measured pose into the text of a cell.toml. The reader of cell files checks the new
text.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np

from yarclang.calibration.writing import with_frame
from yarclang.cell.description import Names, read_cell
from yarclang.cell.frames import ROOTS
from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.source import SourceFile
from yarclang.toml.changes import ChangeError
from yarclang.units import DEG, MM

_NEAR = 5e-6
"""Largest difference between the frame in the new text and the measured pose, which may differ by rounding
[m, and entries of rotation matrices].
"""


class CellFrameError(ValueError):
    """Raised if a frame can't be written into the text of a cell.toml.

    Attributes:
        help: the remedy.
        what: what is wrong: `form`, `frame`, `name`, `parent`, or the code of a finding.
    """

    def __init__(self, message: str, help_: str, what: str) -> None:
        super().__init__(message)
        self.help = help_
        self.what = what


@frozen
class CellWithFrame:
    """A cell.toml with a frame at its new pose.

    Attributes:
        text: the whole file.
        what: description of the change, in words.
        findings: findings of the reader of cell files.
    """

    text: str
    what: str
    findings: tuple[Diagnostic, ...]


def read_frame_cell(source: SourceFile, place: Path, names: Names) -> Cell:
    """Return the cell that the text of a cell.toml describes.

    Raises:
        CellFrameError: the text can't be read.
    """
    read = read_cell(source, place.parent, names)
    if read.value is None:
        first = read.diagnostics[0]
        raise CellFrameError(f"{place.name} can't be read as it is: {first.message}", first.help, first.code)
    return read.value


def with_measured_frame(
    source: SourceFile, place: Path, names: Names, name: str, base_from_frame: Array, parent: str
) -> CellWithFrame:
    """Return a cell.toml in which a frame has a new pose. Comments, order and all other bytes don't change.

    Args:
        source: the current text.
        place: path of the file.
        names: the language's words and the robot, with which the names in the cell are checked.
        name: name of the frame, in upper case.
        base_from_frame: (4, 4) pose of the frame in {B} [m].
        parent: parent of a new frame: one of the cell's stationary frames, or B. A frame that is already
            in the file keeps its parent.

    Raises:
        CellFrameError: the frame can't be written into the text.
    """
    cell = read_frame_cell(source, place, names)
    old = cell.frames.get(name)
    if old is None and ("frames", name) in cell.places:
        raise CellFrameError(
            f"{{{name}}} is in {place.name}, and can't be read", "correct it there first", "frame"
        )
    if old is not None and old.mount.on_flange:
        raise CellFrameError(
            f"{{{name}}} in {place.name} is attached to the flange", "choose another name", "name"
        )
    wanted = old.parent if old is not None else parent.strip("{} ").upper()
    local = np.linalg.inv(_standing(cell, wanted)) @ base_from_frame
    try:
        text = with_frame(source, _key(source.text, name), local, wanted)
    except ChangeError as error:
        raise CellFrameError(
            f"{place.name} has a form that can't be edited automatically: {error}",
            "give the frame its own table [frames.NAME], or edit the file by hand",
            "form",
        ) from None
    after = read_cell(SourceFile(source.name, text), place.parent, names)
    found = None if after.value is None else after.value.frames.get(name)
    if found is None or np.abs(found.mount.transform - base_from_frame).max() > _NEAR:
        said = f": {after.diagnostics[0].message}" if after.diagnostics else ""
        raise CellFrameError(
            f"the edited file wouldn't contain the measured frame{said}",
            "edit the file by hand; nothing was written",
            "form",
        )
    what = (
        f"the frame {{{name}}} is written"
        if old is None
        else moves_text(name, old.mount.transform, base_from_frame)
    )
    hanging = sorted(one.name for one in cell.frames.values() if one.parent == name)
    if hanging:
        what += f"; {', '.join(f'{{{one}}}' for one in hanging)} are attached to it, and move with it"
    return CellWithFrame(text, what, after.diagnostics)


def _key(text: str, name: str) -> str:
    """Return a frame's name as the cell.toml spells it. If the file doesn't have the frame, the name stays in
    upper case.
    """
    tables = tomllib.loads(text).get("frames", {})
    return next((one for one in tables if one.upper() == name), name) if isinstance(tables, dict) else name


def _standing(cell: Cell, name: str) -> Array:
    mount = ROOTS.get(name) or (cell.frames[name].mount if name in cell.frames else None)
    if mount is None or mount.on_flange:
        raise CellFrameError(f"{name[:40]!r} isn't a fixed frame of the cell", "choose B", "parent")
    return mount.transform


def moves_text(name: str, old: Array, new: Array) -> str:
    """Return a sentence with the distance and the angle between the old and the new pose (4, 4) [m] of a
    frame.
    """
    shift = float(np.linalg.norm(new[:3, 3] - old[:3, 3])) / MM
    cosine = (float(np.trace(old[:3, :3].T @ new[:3, :3])) - 1.0) / 2.0
    turn = float(np.arccos(np.clip(cosine, -1.0, 1.0))) / DEG
    return f"{{{name}}} moves by {shift:.3f} mm and turns by {turn:.3f} deg"
