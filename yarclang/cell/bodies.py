"""Obstacles of a cell, and what they share with its zones: which keys belong to a shape, and what shapes and places are in SI."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np

from yarclang.cell.frames import ROOTS, known_frame, mount_of
from yarclang.cell.measures import Measures
from yarclang.cell.model import CellFrame, Mount, Obstacle
from yarclang.cell.schema import CellTable, ObstacleTable, ZoneTable
from yarclang.robot.model import Robot
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from yarclang.toml.draft import missing_mistake, table_name
from yarclang.toml.places import Path
from yarclang.transforms import constant
from yarclang.units import Kind, Unit

Units = Mapping[Kind, Unit] | None
SimpleShape = Box | Sphere | Cylinder | Capsule

_MESHES = (".stl", ".obj", ".dae", ".ply")

SIZES: Mapping[str, tuple[str, ...]] = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "mesh": ("file",),
}
"""The keys that each shape needs."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What bodies are read with: units and findings, the frames, the names of all that the file tries to declare, its folder, and the
    robot (None: the file alone is checked, and joint windows are only looked at).
    """

    measures: Measures
    frames: Mapping[str, CellFrame]
    names: frozenset[str]
    folder: FilePath
    robot: Robot | None
    dropped: frozenset[Path]


def read_obstacle(table: ObstacleTable, path: Path, around: Surroundings) -> Obstacle | None:
    """An obstacle; None with findings."""
    measures = around.measures
    units = measures.of_entry(table.units, path)
    needed = SIZES[table.shape] if table.shape else ()
    every = tuple(dict.fromkeys(key for keys in SIZES.values() for key in keys))
    sound = table.shape is None or belong(table, path, table.shape, needed, every, around)
    mount = mounted(table, path, units, around)
    margin = measures.factor(units, "length", (*path, "margin")) if table.margin else 1.0
    if not sound or table.shape is None:
        return None
    shape = sized_shape(table, path, units, around)
    if table.name is None or shape is None or mount is None or margin is None:
        return None
    return Obstacle(table.name.upper(), shape, mount, table.margin * margin)


def belong(
    table: ObstacleTable | ZoneTable,
    path: Path,
    what: str,
    needed: Sequence[str],
    every: Sequence[str],
    around: Surroundings,
    optional: Sequence[str] = (),
) -> bool:
    """Whether a table has the keys of its shape or rule, and none of another's; findings where it hasn't."""
    sound = True
    for key in every:
        given, place = getattr(table, key) is not None, (*path, key)
        if key in needed and not given:
            sound = False
            # what is required of every obstacle, or had the wrong form, was said
            if key not in table.required and place not in around.dropped:
                mistake = missing_mistake(CellTable, place)
                message = f"{mistake.message.removesuffix('.')}, which {_a(what)} needs."
                around.measures.file.say(mistake.code, place, message, mistake.help, at_key=True)
        elif given and key not in needed and key not in optional:
            sound = False
            keys = ", ".join((*needed, *optional)) or "none of its own"
            message = f"{table_name(path)} has {key}, which {_a(what)} doesn't take."
            remedy = f"Remove it; {_a(what)} has {keys}."
            around.measures.file.say("Y1305", place, message, remedy, at_key=True)
    return sound


def _a(what: str) -> str:
    """How a shape or a rule of a zone is spoken of."""
    spoken = {
        "joints": "a joint window",
        "allowed": "an allowed zone",
        "forbidden": "a forbidden zone",
        "slow": "a slow zone",
        "posture": "a zone for a posture",
    }
    return spoken.get(what, f"a {what}")


def mounted(table: ObstacleTable | ZoneTable, path: Path, units: Units, around: Surroundings) -> Mount | None:
    """Where the origin of a body is."""
    pose = around.measures.transform(table, path, units)
    if table.frame is None:
        return None
    named = {name: name for name in around.names}
    frame = known_frame(table.frame, (*path, "frame"), named, around.measures.file)
    if frame is None or pose is None or (frame not in ROOTS and frame not in around.frames):
        return None
    under = mount_of(frame, around.frames)
    return Mount(constant(under.transform @ pose), under.on_flange)


def sized_shape(table: ObstacleTable, path: Path, units: Units, around: Surroundings) -> Shape | None:
    """The shape of an obstacle [m]; the keys that it needs are there."""
    if table.shape == "mesh":
        unit = around.measures.factor(units, "length", (*path, "file"))
        return _mesh(str(table.file), path, unit, around)
    return simple_shape(table, path, units, around)


def simple_shape(
    table: ObstacleTable | ZoneTable, path: Path, units: Units, around: Surroundings
) -> SimpleShape | None:
    """A shape without a file [m]; the keys that it needs are there."""
    measures = around.measures
    first = SIZES[str(table.shape)][0]
    unit = measures.factor(units, "length", (*path, first))
    if unit is None or not measures.sized(table.size, 3, (*path, "size")):
        return None
    if table.shape == "box":
        return Box(constant(np.array(table.size) * unit))
    radius, length = (table.radius or 0.0) * unit, (table.length or 0.0) * unit
    match table.shape:
        case "sphere":
            return Sphere(radius)
        case "cylinder":
            return Cylinder(radius, length)
        case _:
            return Capsule(radius, length)


def _mesh(name: str, path: Path, unit: float | None, around: Surroundings) -> Mesh | None:
    """The mesh of a file, which is there and isn't empty."""
    place = (*path, "file")
    file = around.measures.file
    if FilePath(name).suffix.lower() not in _MESHES:
        message = f"{name[:80]} isn't the name of a mesh."
        file.say("Y1308", place, message, f"Meshes end in {', '.join(_MESHES)}.")
        return None
    try:
        content = (around.folder / name).read_bytes()
    except (OSError, ValueError):
        content = None
    if not content:
        message = f"The mesh {name[:80]} is {'not there' if content is None else 'empty'}."
        file.say("Y1357", place, message, "Put the file there; it is seen from the folder of this file.")
        return None
    if unit is None:
        return None
    return Mesh((around.folder / name).absolute(), unit, hashlib.sha256(content).hexdigest())
