"""Pairs of bodies that a cell allows to touch (`[[allow]]`), and the names by which programs may name
bodies.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from yarclang.cell.frames import ROOTS, known_frame
from yarclang.cell.model import CellAllowance
from yarclang.toml.file import did_you_mean

if TYPE_CHECKING:
    from yarclang.cell.bodies import Surroundings
    from yarclang.cell.model import Cell
    from yarclang.cell.schema import AllowTable, CellTable
    from yarclang.robot.model import Robot
    from yarclang.toml.places import Path


def robot_bodies(robot: Robot) -> tuple[str, ...]:
    """Return the names of the links and mounted tools that have shapes, each once."""
    links = [one.link for one in robot.shapes]
    tools = [one.name for one in robot.tools if one.mounted and one.shapes]
    return tuple(dict.fromkeys((*links, *tools)))


def body_names(robot: Robot, cell: Cell | None) -> Counter[str]:
    """Return the names in upper case of all bodies in the cell and of the robot, with the number of bodies
    that have each name.
    """
    names = [one.upper() for one in robot_bodies(robot)]
    if cell is not None:
        names += [one.name for one in cell.obstacles] + [one.body.name for one in cell.parts]
    return Counter(names)


def repeated_parts(cell: Cell | None) -> frozenset[str]:
    """Return the names of the workpieces that come several times, one after the other."""
    return frozenset(() if cell is None else (one.body.name for one in cell.parts if one.count > 1))


def pair_fault(pair: tuple[str, str], names: Counter[str], repeated: Iterable[str]) -> str:
    """Return why a pair of existing body names isn't a pair that may be allowed to touch, as the start of a
    sentence; empty if it may.

    Args:
        pair: two names in upper case.
        names: the names of all bodies, with the number of bodies of each name.
        repeated: names of the workpieces that come several times.
    """
    first, second = pair
    if first == second and first not in repeated:
        return f"{first} is one body, and can't touch itself"
    for name in pair:
        if names[name] > 1:
            return f"{name} is the name of {names[name]} bodies"
    return ""


def read_allowances(table: CellTable, around: Surroundings) -> tuple[CellAllowance, ...]:
    """Read the `[[allow]]` entries of a cell.toml: return the correct ones, and report the others."""
    robot = around.robot
    own = () if robot is None else robot_bodies(robot)
    listed = [one.name.upper() for one in (*table.obstacles, *table.parts) if one.name is not None]
    names = Counter([*(one.upper() for one in own), *dict.fromkeys(listed)])
    repeated = [one.name.upper() for one in table.parts if one.name is not None and one.count > 1]
    found: list[CellAllowance] = []
    for at, entry in enumerate(table.allow):
        found += _read(entry, ("allow", at), around, names, repeated)
    return tuple(dict.fromkeys(found))


def _read(
    entry: AllowTable, path: Path, around: Surroundings, names: Counter[str], repeated: list[str]
) -> Iterator[CellAllowance]:
    file = around.measures.file
    frames = [_frame(name, (*path, key), around) for key, name in _frames(entry)]
    if not frames and not any((*path, key) in around.dropped for key in ("leads_to", "leaves")):
        message = "The entry says nowhere on which motions its bodies may touch."
        file.say(
            "Y1379", path, message, 'Write leads_to = "STACK" or leaves = "STACK", a frame of this file.'
        )
    if entry.bodies is None:
        return
    if len(entry.bodies) != 2:
        message = (
            f"bodies has {len(entry.bodies)} names; it takes the names of the two bodies that may touch."
        )
        file.say("Y1308", (*path, "bodies"), message, 'For example bodies = ["GRIPPER", "BOX"].')
        return
    first, second = sorted(name.upper() for name in entry.bodies)
    unknown = [at for at, name in enumerate(entry.bodies) if name.upper() not in names]
    # if the robot isn't known, an unknown name may be that of a link or tool
    for at in unknown if around.robot is not None else ():
        remedy, subject = did_you_mean(entry.bodies[at].upper(), names)
        message = f"{entry.bodies[at][:40]} is no body of the cell or of the robot."
        file.say("Y1377", (*path, "bodies", at), message, remedy, subject)
    fault = "" if unknown else pair_fault((first, second), names, repeated)
    if fault:
        file.say("Y1308", (*path, "bodies"), f"{fault}.", "Name two bodies, each by a name of its own.")
    if not frames or None in frames or unknown or fault:
        return
    line = file.places.of_key(path).line
    for (key, _), frame in zip(_frames(entry), frames, strict=True):
        there = (frame or "", "") if key == "leads_to" else ("", frame or "")
        yield CellAllowance(first, second, *there, line)


def _frames(entry: AllowTable) -> tuple[tuple[str, str], ...]:
    """Return the keys of an entry that name frames, with the names."""
    keys = ("leads_to", entry.leads_to), ("leaves", entry.leaves)
    return tuple((key, name) for key, name in keys if name is not None)


def _frame(name: str, path: Path, around: Surroundings) -> str | None:
    """Return a frame that the file declares; None for a wrong name, which is reported."""
    file = around.measures.file
    frame = known_frame(name, path, {one: one for one in around.names}, file)
    if frame in ROOTS:
        message = f"{name[:40]} is a frame of every robot: nearly all motions lead there."
        file.say("Y1379", path, message, "Name a frame of this file, at the place where the bodies touch.")
        return None
    return frame
