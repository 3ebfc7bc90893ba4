"""Read the obstacles of a cell: check the keys of each shape, and convert shapes and poses to SI units. Zones
are read with the same functions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path as FilePath

from yarclang.cell.frames import ROOTS, known_frame, mount_of
from yarclang.cell.measures import Measures
from yarclang.cell.model import CellFrame, Mount, Obstacle
from yarclang.cell.schema import BodyTable, CellTable, KeepTable, RackTable, SensorTable, ZoneTable
from yarclang.frozen import frozen
from yarclang.robot.model import Robot
from yarclang.shapes import Shape
from yarclang.toml import bodies
from yarclang.toml.bodies import OF_MESHES, OF_SHAPES, SIZES, Keys, SimpleShape, has_its_keys, named_mesh
from yarclang.toml.places import Path
from yarclang.transforms import constant
from yarclang.units import Kind, Unit

Units = Mapping[Kind, Unit] | None


@frozen
class Surroundings:
    """The context in which the bodies of a cell.toml are read.

    Attributes:
        measures: units of the file, and its findings.
        frames: the resolved frames.
        names: the names of all frames that the file declares, including frames with mistakes.
        folder: folder of the file.
        robot: the robot; None if the file is checked without a robot. Joint windows are then checked only as
            far as possible.
        dropped: places of keys that couldn't be read.
        tools: names of the tools that the file declares as changeable.
    """

    measures: Measures
    frames: Mapping[str, CellFrame]
    names: frozenset[str]
    folder: FilePath
    robot: Robot | None
    dropped: frozenset[Path]
    tools: frozenset[str] = frozenset()


def read_obstacle(table: BodyTable, path: Path, around: Surroundings) -> Obstacle | None:
    """Read an obstacle of a cell.toml. Report mistakes, and return None if there are any."""
    measures = around.measures
    units = measures.of_entry(table.units, path)
    needed = SIZES[table.shape] if table.shape else ()
    optional = OF_MESHES if table.shape == "mesh" else ()
    every = (*OF_SHAPES, *OF_MESHES)
    sound = table.shape is None or belong(table, path, table.shape, needed, every, around, optional)
    mount = mounted(table, path, units, around)
    margin = measures.factor(units, "length", (*path, "margin")) if table.margin else 1.0
    if not sound or table.shape is None:
        return None
    shape = sized_shape(table, path, units, around)
    if table.name is None or shape is None or mount is None or margin is None:
        return None
    return Obstacle(table.name.upper(), shape, mount, table.margin * margin)


def belong(
    table: BodyTable | ZoneTable | SensorTable | KeepTable,
    path: Path,
    what: str,
    needed: Sequence[str],
    every: Sequence[str],
    around: Surroundings,
    optional: Sequence[str] = (),
) -> bool:
    """Return True if a TOML table has the keys that its shape or rule needs, and no keys of another shape or
    rule. Otherwise report the missing keys and the keys that don't belong there.

    Args:
        table: the table.
        path: path of the table in the file.
        what: the table's shape, rule or kind of sensor.
        needed: the keys that this shape, rule or kind needs.
        every: the keys of all shapes, rules or kinds.
        around: findings are added to its file.
        optional: the keys that this shape, rule or kind may have.
    """
    keys = Keys(_a(what), needed, optional)
    place = (around.measures.file, CellTable, path)
    return has_its_keys(table, place, keys, every, around.dropped)


def _a(what: str) -> str:
    """Return the name of a shape, or of a zone's rule, with its article."""
    spoken = {
        "joints": "a joint window",
        "allowed": "an allowed zone",
        "forbidden": "a forbidden zone",
        "slow": "a slow zone",
        "posture": "a zone for a posture",
        "beam": "a light beam",
        "proximity": "a proximity sensor",
        "vacuum": "a vacuum sensor",
        "upright": "the rule upright",
        "above": "the rule above",
        "facing": "the rule facing",
        "seen": "the rule seen",
    }
    return spoken.get(what, f"a {what}")


def mounted(
    table: BodyTable | ZoneTable | SensorTable | RackTable, path: Path, units: Units, around: Surroundings
) -> Mount | None:
    """Return the pose of a body's origin. Report a wrong entry, and return None for it."""
    pose = around.measures.transform(table, path, units)
    if table.frame is None:
        return None
    named = {name: name for name in around.names}
    frame = known_frame(table.frame, (*path, "frame"), named, around.measures.file)
    if frame is None or pose is None or (frame not in ROOTS and frame not in around.frames):
        return None
    under = mount_of(frame, around.frames)
    told = around.measures.told(table, units)
    return Mount(constant(under.transform @ pose), under.on_flange, (*(under.told or ()), told))


def sized_shape(table: BodyTable, path: Path, units: Units, around: Surroundings) -> Shape | None:
    """Return the shape [m] of an obstacle whose required keys are present. Report a wrong entry, and return
    None for it.
    """
    if table.shape == "mesh":
        place = (*path, "file")
        unit = around.measures.factor(units, "length", place)
        pieces = table.pieces or 0
        return named_mesh(str(table.file), unit, (around.measures.file, place), around.folder, pieces)
    return simple_shape(table, path, units, around)


def simple_shape(
    table: BodyTable | ZoneTable, path: Path, units: Units, around: Surroundings
) -> SimpleShape | None:
    """Return a box, sphere or other shape that needs no mesh file, in [m], if all its keys are present;
    otherwise None.
    """
    measures = around.measures
    first = SIZES[str(table.shape)][0]
    unit = measures.factor(units, "length", (*path, first))
    if unit is None or not measures.sized(table.size, 3, (*path, "size")):
        return None
    return bodies.simple_shape(str(table.shape), table, unit)
