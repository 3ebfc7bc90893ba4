"""Resolve the frames of a cell. Frames may be declared in any order; the chain of parents of each must end at
{B} or {FLANGE}.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from yarclang.cell.measures import Measures
from yarclang.cell.model import CellFrame, Mount
from yarclang.cell.schema import FrameTable
from yarclang.subjects import Name
from yarclang.toml.circles import circles
from yarclang.toml.draft import spoken
from yarclang.toml.file import TomlFile, did_you_mean
from yarclang.toml.places import Path
from yarclang.transforms import constant

ROOTS: Mapping[str, Mount] = {
    "B": Mount(constant(np.eye(4)), on_flange=False, told=()),
    "FLANGE": Mount(constant(np.eye(4)), on_flange=True, told=()),
}
"""The frames that every robot has. The chain of parents of each frame in a cell ends at one of them."""


FROM_THE_ROBOT = ("B", "FLANGE", "TCP")
"""Names of frames that a cell can't declare, since they are frames of the robot."""


def resolve_frames(tables: Mapping[str, FrameTable], measures: Measures) -> dict[str, CellFrame]:
    """Return the frames of a cell by name in upper case, parents first; report frames whose chain of parents
    doesn't end at {B} or {FLANGE}.

    Frames with mistakes, and frames with such a frame as parent, are left out.
    """
    upper = {name.upper(): name for name in reversed([*tables]) if name.upper() not in FROM_THE_ROBOT}
    parents: dict[str, str] = {}
    local = {}
    for name, table in tables.items():
        path: Path = ("frames", name)
        units = measures.of_entry(table.units, path)
        pose = measures.transform(table, path, units)
        if table.parent is None or upper.get(name.upper()) != name:
            continue  # already reported: no parent, a repeated name, or a name of the robot's frames
        parent = known_frame(table.parent, (*path, "parent"), upper, measures.file)
        if parent is not None:
            parents[name.upper()] = parent
            if pose is not None:
                local[name.upper()] = pose, measures.told(table, units)
    for circle in circles(parents):
        message = f"The frames {', '.join(circle)} are each other's parents in a circle."
        if len(circle) == 1:
            message = f"The frame {circle[0]} is its own parent."
        remedy = 'Give one of them parent = "B", or "FLANGE".'
        measures.file.say("Y1330", ("frames", upper[circle[0]], "parent"), message, remedy)
    placed: dict[str, CellFrame] = {}
    waiting = dict(local)
    while ready := [name for name in waiting if parents[name] in ROOTS or parents[name] in placed]:
        for name in ready:
            parent, (pose, told) = parents[name], waiting.pop(name)
            under = mount_of(parent, placed)
            mount = Mount(constant(under.transform @ pose), under.on_flange, (*(under.told or ()), told))
            placed[name] = CellFrame(name, parent, pose, mount)
    return placed


def known_frame(name: str, path: Path, frames: Mapping[str, object], file: TomlFile) -> str | None:
    """Return the name, in upper case, of a frame of the cell or of the robot; if there is no such frame,
    report it and return None.

    Args:
        name: the frame's name in any case.
        path: where the name is in the file.
        frames: the frames of the file, by their names in upper case.
        file: findings are added to it.
    """
    wanted = name.upper()
    if wanted in ROOTS or wanted in frames:
        return wanted
    remedy, subject = did_you_mean(wanted, {*ROOTS, *frames} - {str(path[1]).upper()})
    if wanted == "TCP":
        remedy, subject = (
            "{TCP} differs from robot to robot: name FLANGE, or a frame of this file.",
            Name(wanted),
        )
    message = f"{spoken(path)} is {name[:40]}, which isn't a frame of this file."
    file.say("Y1329", path, message, remedy, subject)
    return None


def mount_of(name: str, frames: Mapping[str, CellFrame]) -> Mount:
    """Return the mount of a frame. The frame must be a root or among `frames`."""
    return ROOTS[name] if name in ROOTS else frames[name].mount
