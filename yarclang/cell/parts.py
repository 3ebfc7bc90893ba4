"""Read the workpieces of a cell, and the outputs that take, put down or remove them."""

from __future__ import annotations

from dataclasses import replace

from yarclang.cell.bodies import Surroundings, read_obstacle
from yarclang.cell.frames import ROOTS, known_frame, mount_of
from yarclang.cell.model import Grip, Part, Removal
from yarclang.cell.schema import OutputTable, PartTable
from yarclang.cell.tools import own_frame, read_lock, tool_of
from yarclang.toml.places import Path

REACH = 0.010
"""Reach of grippers and machines [m], if the file doesn't set it."""


def read_part(table: PartTable, path: Path, around: Surroundings) -> Part | None:
    """Read a workpiece of a cell.toml. Report mistakes, and return None if there are any."""
    body = read_obstacle(table, path, around)
    if body is None:
        return None
    if body.mount.on_flange and table.count > 1:
        message = (
            f"{body.name} is fixed to {table.frame}, which the robot carries: count can only be 1, not "
            f"{table.count}."
        )
        around.measures.file.say(
            "Y1308", (*path, "count"), message, "Remove count, or name a frame that is fixed to B."
        )
        return None
    frame = (table.frame or "").upper()
    return Part(replace(body, mass=table.mass, is_part=True), table.count, frame)


def read_grip(table: OutputTable, path: Path, around: Surroundings) -> Grip | Removal | None:
    """Return the gripper that an output moves, or the machine that removes workpieces when the output is set.
    Return None for other outputs. Report a wrong entry, and return None for it.
    """
    file = around.measures.file
    if table.locks_at is not None:
        return read_lock(table, path, around)
    key = "grips" if table.grips is not None else "removes"
    name = getattr(table, key)
    for other, wanted in (
        ("grips_at", "grips"),
        ("removes_at", "removes"),
        ("tool", "grips"),
        ("reach", key),
    ):
        if getattr(table, other) is not None and getattr(table, wanted) is None:
            message = f"The output {path[-1]} has {other}, but neither grips nor removes parts."
            remedy = f'Add {wanted} = "FRAME", the frame at which it does so.'
            file.say("Y1305", (*path, other), message, remedy, at_key=True)
            return None
    if name is None:
        return None
    if table.grips is not None and table.removes is not None:
        message = f"The output {path[-1]} has both grips and removes, and only one is allowed."
        file.say("Y1305", (*path, "removes"), message, "Remove one of them.", at_key=True)
        return None
    factor = (
        around.measures.factor(around.measures.common, "length", (*path, "reach")) if table.reach else 1.0
    )
    own = own_frame(name, table, around)
    frame = (
        name.upper() if own else known_frame(name, (*path, key), {each: each for each in around.names}, file)
    )
    if frame is None or factor is None or (own is None and frame not in ROOTS and frame not in around.frames):
        return None
    mount = own or mount_of(frame, around.frames)
    if mount.on_flange != (key == "grips"):
        stands = "which the robot carries" if mount.on_flange else "which doesn't move with the robot"
        message = f"The output {path[-1]} {key} at {frame}, {stands}."
        wanted = (
            "Name B, or a frame that is fixed to B."
            if mount.on_flange
            else "Name FLANGE, or a frame that is fixed to FLANGE."
        )
        file.say("Y1374", (*path, key), message, wanted)
        return None
    reach = REACH if table.reach is None else table.reach * factor
    at = getattr(table, f"{key}_at")
    value = 1.0 if at is None else at
    if not mount.on_flange:
        return Removal(frame, mount.transform, reach, value)
    tool = None if table.tool is None else tool_of(table.tool, (*path, "tool"), around)
    return Grip(frame, mount.transform, reach, value, tool)
