"""Read bodies from TOML files: check the keys that each shape needs, and convert a table to a shape with
lengths in m.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path as FilePath
from typing import Protocol

import numpy as np

from yarclang.files import LARGEST_MESH, read_whole
from yarclang.frozen import frozen
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Sphere
from yarclang.toml.draft import missing_mistake, table_name
from yarclang.toml.file import TomlFile
from yarclang.toml.places import Path
from yarclang.toml.tables import Document, Table
from yarclang.transforms import constant

SimpleShape = Box | Sphere | Cylinder | Capsule

MESHES = (".stl", ".obj", ".dae", ".ply")
"""Suffixes of mesh files."""

SIZES: Mapping[str, tuple[str, ...]] = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "mesh": ("file",),
}
"""The keys that each shape needs."""
OF_SHAPES = tuple(dict.fromkeys(key for keys in SIZES.values() for key in keys))
"""The keys of all shapes."""
OF_MESHES = ("pieces",)
"""Further keys that a table may have if its shape is a mesh."""


class Sized(Protocol):
    """A table with the sizes of a shape."""

    @property
    def size(self) -> Sequence[float] | None:
        """Edges of a box."""
        ...

    @property
    def radius(self) -> float | None:
        """Radius of a sphere, cylinder or capsule."""
        ...

    @property
    def length(self) -> float | None:
        """Length of a cylinder, or of a capsule without its caps."""
        ...


@frozen
class Keys:
    """The keys that a table must have, and those that it may have, because of its shape or because of another
    rule.

    Attributes:
        what: the shape or rule in words.
        needed: the required keys.
        optional: the optional keys.
    """

    what: str
    needed: Sequence[str]
    optional: Sequence[str] = ()


def has_its_keys(
    table: Table,
    place: tuple[TomlFile, type[Document], Path],
    keys: Keys,
    every: Sequence[str],
    dropped: Collection[Path],
) -> bool:
    """Check that a table has the keys that its shape or rule needs, and no keys of another shape or rule;
    report findings.

    Args:
        table: the table.
        place: file of the table, schema of the file, and path of the table.
        keys: the keys that the table should have.
        every: the keys of all shapes or rules.
        dropped: the keys with a wrong form, which was reported already.

    Returns:
        True if the keys are right.
    """
    file, document, path = place
    sound = True
    for key in every:
        given, at = getattr(table, key) is not None, (*path, key)
        if key in keys.needed and not given:
            sound = False
            # Don't report keys that all tables of this kind need, or keys with a wrong form: they were
            # reported already.
            if key not in table.required and at not in dropped:
                missing_mistake(document, at, f", which {keys.what} needs").tell(file)
        elif given and key not in keys.needed and key not in keys.optional:
            sound = False
            known = ", ".join((*keys.needed, *keys.optional)) or "none of its own"
            message = f"{table_name(path)} has {key}, which {keys.what} doesn't take."
            file.say("Y1305", at, message, f"Remove it; {keys.what} has {known}.", at_key=True)
    return sound


def simple_shape(shape: str, table: Sized, unit: float) -> SimpleShape:
    """Return a box, sphere or other shape that needs no mesh file, in [m].

    Args:
        shape: name of the shape.
        table: a table that has the shape's keys.
        unit: unit of lengths in the table [m].
    """
    if shape == "box":
        return Box(constant(np.array(table.size) * unit))
    radius, length = (table.radius or 0.0) * unit, (table.length or 0.0) * unit
    match shape:
        case "sphere":
            return Sphere(radius)
        case "cylinder":
            return Cylinder(radius, length)
        case _:
            return Capsule(radius, length)


def named_mesh(
    name: str, unit: float | None, place: tuple[TomlFile, Path], folder: FilePath, pieces: int = 0
) -> Mesh | None:
    """Return the mesh that a TOML file names, if the mesh file exists and isn't empty. Otherwise return None,
    with a finding. Also return None if the unit isn't known.

    Args:
        name: name of the mesh file, relative to the folder.
        unit: unit of lengths in the mesh file [m]; None if it isn't known.
        place: the TOML file, and the path of the name in it.
        folder: folder of the TOML file.
        pieces: largest number of convex pieces that replace the mesh; 0 for none.
    """
    file, path = place
    if FilePath(name).suffix.lower() not in MESHES:
        message = f"{name[:80]} isn't the name of a mesh file."
        file.say("Y1308", path, message, f"Names of mesh files end in {', '.join(MESHES)}.")
        return None
    try:
        content = read_whole(folder / name, LARGEST_MESH)
    except OSError:
        content = None
    if not content:
        message = f"The mesh {name[:80]} is {'not there' if content is None else 'empty'}."
        file.say("Y1357", path, message, "Put the file there; paths start from the folder of this file.")
        return None
    if unit is None:
        return None
    return Mesh((folder / name).absolute(), unit, hashlib.sha256(content).hexdigest(), pieces=pieces)
