"""Read the pairs of bodies that a cell allows to touch (`[[allow]]`), and list the names of bodies."""

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
    """Count the bodies of the cell and the robot by their names in upper case."""
    names = [one.upper() for one in robot_bodies(robot)]
    if cell is not None:
        names += [one.name for one in cell.obstacles] + [one.body.name for one in cell.parts]
    return Counter(names)


def repeated_parts(cell: Cell | None) -> frozenset[str]:
    """Return the names of workpieces with a count above 1. Such workpieces appear one after the other."""
    return frozenset(() if cell is None else (one.body.name for one in cell.parts if one.count > 1))


def pair_fault(pair: tuple[str, str], names: Counter[str], repeated: Iterable[str]) -> str:
    """Return the reason why two bodies can't be allowed to touch, as the start of a sentence; empty if they
    can. Bodies of both names exist.

    Args:
        pair: two names in upper case.
        names: the names of all bodies, with the number of bodies of each name.
        repeated: names of the workpieces that come several times.
    """
    first, second = pair
    if first == second and first not in repeated:
        return f"{first} is given twice: a body can't touch itself"
    for name in pair:
        if names[name] > 1:
            return f"{name} is the name of {names[name]} bodies"
    return ""


def read_allowances(table: CellTable, around: Surroundings) -> tuple[CellAllowance, ...]:
    """Read the `[[allow]]` entries of a cell.toml. Return the correct entries, and report the wrong ones."""
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
        message = "The entry doesn't name the motions on which its bodies may touch."
        file.say(
            "Y1379", path, message, 'Write leads_to = "STACK" or leaves = "STACK", a frame of this file.'
        )
    if entry.bodies is None:
        return
    if len(entry.bodies) != 2:
        message = f"bodies has {len(entry.bodies)} names; write the two bodies that may touch."
        file.say("Y1308", (*path, "bodies"), message, 'For example bodies = ["GRIPPER", "BOX"].')
        return
    first, second = sorted(name.upper() for name in entry.bodies)
    unknown = [at for at, name in enumerate(entry.bodies) if name.upper() not in names]
    # Without a robot, unknown names aren't reported: they may be names of links or tools.
    for at in unknown if around.robot is not None else ():
        remedy, subject = did_you_mean(entry.bodies[at].upper(), names)
        message = f"{entry.bodies[at][:40]} isn't a body of the cell or of the robot."
        file.say("Y1377", (*path, "bodies", at), message, remedy, subject)
    fault = "" if unknown else pair_fault((first, second), names, repeated)
    if fault:
        file.say("Y1308", (*path, "bodies"), f"{fault}.", "Give each body a name of its own.")
    if not frames or None in frames or unknown or fault:
        return
    line = file.places.of_key(path).line
    for (key, _), frame in zip(_frames(entry), frames, strict=True):
        there = (frame or "", "") if key == "leads_to" else ("", frame or "")
        yield CellAllowance(first, second, *there, line)


def _frames(entry: AllowTable) -> tuple[tuple[str, str], ...]:
    """Return the frame keys that an entry has (`leads_to`, `leaves`), each with the name of its frame."""
    keys = ("leads_to", entry.leads_to), ("leaves", entry.leaves)
    return tuple((key, name) for key, name in keys if name is not None)


def _frame(name: str, path: Path, around: Surroundings) -> str | None:
    """Return the name of a frame that the file declares, in upper case. Report a wrong name, and return None
    for it.
    """
    file = around.measures.file
    frame = known_frame(name, path, {one: one for one in around.names}, file)
    if frame in ROOTS:
        message = f"{name[:40]} is a frame of every robot: nearly all motions end there."
        file.say("Y1379", path, message, "Name a frame of this file, at the place where the bodies touch.")
        return None
    return frame
