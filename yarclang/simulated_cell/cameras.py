"""Reader for the cameras in a script file of a simulated cell. Findings refer to lines of the file.

Pydantic is imported at its first use.
"""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import TYPE_CHECKING

from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.simulated_cell.camera import CameraForm
from yarclang.simulated_cell.script import Known
from yarclang.source import SourceFile
from yarclang.toml.file import TomlFile, did_you_mean
from yarclang.toml.places import Path, find_places
from yarclang.toml.reading import parse_toml, read_text
from yarclang.transforms import pose_matrix
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.simulated_cell.schema import CameraTable

_TOLD = ("found", "x", "y", "z", "rz")


def load_cameras(path: FilePath, known: Known, cell: Cell | None) -> Result[tuple[CameraForm, ...]]:
    """Read the cameras in a script file. The inputs in the file must already have been read without a
    finding.

    Args:
        path: path of the file.
        known: names that the program declares.
        cell: the cell whose parts and frames the cameras use; None if there is none.

    Returns:
        The cameras, or None with findings.
    """
    source = read_text(path, "Name a script of inputs, a TOML file.")
    if isinstance(source, Diagnostic):
        return Result(None, (source,))
    return read_cameras(source, known, cell)


def read_cameras(source: SourceFile, known: Known, cell: Cell | None) -> Result[tuple[CameraForm, ...]]:
    """Read the cameras in the text of a script file, as `load_cameras` does."""
    from yarclang.simulated_cell.schema import ScriptTable
    from yarclang.toml.draft import read_draft

    data = parse_toml(source)
    if isinstance(data, Diagnostic):
        return Result(None, (data,))
    cameras = data.get("cameras")
    if not cameras:
        return Result(())
    file = TomlFile(source, find_places(source))
    draft = read_draft({"cameras": cameras}, ScriptTable)
    draft.tell(file)
    forms = [_form(one, ("cameras", at), known, cell, file) for at, one in enumerate(draft.table.cameras)]
    found = in_order(file.findings)
    made = tuple(one for one in forms if one is not None)
    return Result(None if has_errors(found) else made, found)


def _form(
    table: CameraTable, path: Path, known: Known, cell: Cell | None, file: TomlFile
) -> CameraForm | None:
    if table.part is None or table.frame is None:
        return None
    if not known.has_places:
        message = f"The {table.name[:40]} answers a program, which a controller doesn't know."
        file.say("Y1617", path, message, "Use `yarc run --inputs`, without --to.")
        return None
    parts = () if cell is None else tuple(one.body.name for one in cell.parts)
    frames = {} if cell is None else dict(cell.frames)
    part, frame = table.part.upper(), table.frame.strip("{} ").upper()
    good = True
    if part not in parts:
        file.say(
            "Y1617", (*path, "part"), f"No part of the cell is named {part[:40]}.", *did_you_mean(part, parts)
        )
        good = False
    if frame not in frames:
        message = f"No frame of the cell is named {frame[:40]}."
        file.say("Y1617", (*path, "frame"), message, *did_you_mean(frame, frames))
        good = False
    registers: dict[str, str] = {}
    for key in _TOLD:
        name = getattr(table, key)
        if name is None:
            continue
        if name.upper() in registers.values():
            file.say("Y1618", (*path, key), f"{name[:40]} stands twice.", "Each register gets one thing.")
            good = False
        elif known.registers is not None and name.upper() not in known.registers:
            message = f"The program has no register {name[:40]} that is filled from outside."
            file.say("Y1617", (*path, key), message, *did_you_mean(name.upper(), known.registers))
            good = False
        registers[key] = name.upper()
    if not registers:
        message = f"The {table.name[:40]} fills no register."
        file.say("Y1618", path, message, 'Name one, for example x = "X" and found = "SEEN".')
        good = False
    if not good:
        return None
    lies = tuple(
        pose_matrix([*(one * MM for one in (x, y, z)), 0.0, 0.0, turn * DEG]) for x, y, z, turn in table.lies
    )
    does = tuple(table.does)
    return CameraForm(table.name, part, frames[frame], registers, table.unit, table.delay, does, lies)
