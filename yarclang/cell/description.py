"""Read a cell.toml: convert it to a `Cell` for a robot, and report its mistakes as findings.

pydantic is imported only when it is first used.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path as FilePath
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from yarclang.cell.model import Array, Cell, CellOutput, Grip, Removal, Zone
from yarclang.diagnostics import Diagnostic, Result, in_order
from yarclang.frozen import frozen
from yarclang.robot.kinds import known_signal
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span
from yarclang.toml.file import TomlFile
from yarclang.toml.places import Path, find_places
from yarclang.toml.reading import parse_toml, read_text

if TYPE_CHECKING:
    from yarclang.cell.bodies import Surroundings
    from yarclang.cell.measures import Measures
    from yarclang.cell.schema import CellTable, OutputTable
    from yarclang.toml.draft import Draft

IsWord = Callable[[str], bool]
"""Function that returns True if a name in upper case is a word of the language."""

_NAME = re.compile(r"[A-Z_][A-Z0-9_]*")


@frozen
class Names:
    """Names with which the names in a cell.toml must not collide: the language's words, and the names of the
    robot if it is known.
    """

    is_word: IsWord
    robot: Robot | None = None


def load_cell(path: FilePath, names: Names) -> Result[Cell]:
    """Read a cell.toml for a robot.

    Args:
        path: path of the file.
        names: the language's words and the robot.

    Returns:
        As for `read_cell`. A missing file is a finding without a place.
    """
    source = read_text(path, "Write the path of a cell.toml, relative to the folder of the program.")
    if isinstance(source, Diagnostic):
        return Result(None, (source,))
    return read_cell(source, path.parent, names)


def read_cell(source: SourceFile, folder: FilePath, names: Names) -> Result[Cell]:
    """Read the cell that the text of a cell.toml describes.

    Args:
        source: the text.
        folder: folder of the file. Paths of mesh files are relative to it.
        names: the language's words and the robot. Without a robot, only what doesn't depend on one is
            checked.

    Returns:
        A cell of the correct entries, with findings about the wrong ones; `Cell.places` includes the names of
        wrong entries. The cell is None if the text isn't TOML, and also if no robot is given.
    """
    data = parse_toml(source)
    if isinstance(data, Diagnostic):
        return Result(None, (data,))
    return _read(source, folder, names, data)


def _read(source: SourceFile, folder: FilePath, names: Names, data: dict[str, Any]) -> Result[Cell]:
    from yarclang.cell.allowances import read_allowances
    from yarclang.cell.bodies import Surroundings, read_obstacle
    from yarclang.cell.frames import resolve_frames
    from yarclang.cell.measures import Measures
    from yarclang.cell.parts import read_part
    from yarclang.cell.rules import read_rules
    from yarclang.cell.schema import CellTable, spelled_out
    from yarclang.cell.sensors import read_sensor
    from yarclang.cell.starts import read_start
    from yarclang.cell.tools import read_tools
    from yarclang.cell.zones import read_zone
    from yarclang.toml.draft import read_draft

    file = TomlFile(source, find_places(source))
    draft = read_draft(spelled_out(data), CellTable)
    draft.tell(file)
    table = draft.table
    measures = Measures(file)
    measures.read_common(table.units)
    measures.doubtful |= ("units",) in draft.dropped
    _check_names(file, draft, names)
    frames = resolve_frames(table.frames, measures)
    declared = {name.upper() for name in table.frames} | {
        str(path[1]).upper() for path in draft.dropped if path[0] == "frames" and len(path) > 1
    }
    racked = frozenset(one.name.upper() for one in table.tools if one.name is not None)
    around = Surroundings(measures, frames, frozenset(declared), folder, names.robot, draft.dropped, racked)
    obstacles = [read_obstacle(one, ("obstacles", at), around) for at, one in enumerate(table.obstacles)]
    zones = [read_zone(one, ("zones", at), around) for at, one in enumerate(table.zones)]
    joints = _joints(table, measures, names.robot)
    inputs = {
        name.upper(): variable
        for name, entry in table.inputs.items()
        if (variable := _variable(entry.variable, ("inputs", name, "variable"), file, names.robot))
    }
    parts = [read_part(one, ("parts", at), around) for at, one in enumerate(table.parts)]
    outputs = {
        name.upper(): _output(variable, entry, ("outputs", name), around)
        for name, entry in table.outputs.items()
        if (variable := _variable(entry.variable, ("outputs", name, "variable"), file, names.robot))
    }
    parts += read_tools(table, outputs, around)
    sensors = [
        read_sensor(one, ("sensors", at), around, inputs, outputs) for at, one in enumerate(table.sensors)
    ]
    starts = [read_start(one, ("starts", at), measures, names.robot) for at, one in enumerate(table.starts)]
    allowances = read_allowances(table, around)
    rules = read_rules(table, around)
    findings = in_order(file.findings)
    if names.robot is None:
        return Result(None, findings)
    is_locked = any(one.grip is not None and one.grip.changes for one in outputs.values())
    cell = Cell(
        source,
        MappingProxyType(frames),
        MappingProxyType(joints),
        MappingProxyType(inputs),
        MappingProxyType(outputs),
        tuple(one for one in obstacles if one is not None),
        (*(one for one in zones if one is not None), *(zone for zone, _ in rules.values())),
        MappingProxyType(_places(file, table, is_locked=is_locked)),
        MappingProxyType(_zone_places(file, table) | _rule_places(file, rules)),
        tuple(one for one in parts if one is not None),
        tuple(one for one in sensors if one is not None),
        starts=tuple(one for one in starts if one is not None),
        allowances=allowances,
    )
    return Result(cell, findings)


def _joints(table: CellTable, measures: Measures, robot: Robot | None) -> dict[str, Array]:
    from yarclang.cell.windows import joint_position

    found: dict[str, Array] = {}
    for name, entry in table.joints.items():
        path: Path = ("joints", name)
        units = measures.of_entry(entry.units, path)
        if entry.values is not None:
            # short form: the values are given directly after the name
            at = path if (*path, "values") not in measures.file.places.values else (*path, "values")
            q = joint_position(name, entry.values, at, units, measures, robot)
            if q is not None:
                found[name.upper()] = q
    return found


def _output(variable: str, entry: OutputTable, path: Path, around: Surroundings) -> CellOutput:
    from yarclang.cell.parts import read_grip

    does = read_grip(entry, path, around)
    grip = does if isinstance(does, Grip) else None
    return CellOutput(variable, entry.safe, grip, does if isinstance(does, Removal) else None)


def _variable(text: str | None, path: Path, file: TomlFile, robot: Robot | None) -> str | None:
    """Return the controller's variable of an input or output. Report a text that names no variable, and
    return None for it.
    """
    if text is None:
        return None
    variable = robot.controller.signal(text.upper()) if robot else known_signal(text.upper())
    if variable.name is None:
        file.say("Y0413", path, f"{text[:40]} {variable.fault}.", f"{variable.remedy.capitalize()}.")
    return variable.name


_WHAT = {
    "frames": "frame",
    "joints": "joint position",
    "inputs": "input",
    "outputs": "output",
    "obstacles": "obstacle",
    "zones": "zone",
    "parts": "part",
    "tools": "tool",
    "starts": "start zone",
}


def _check_names(file: TomlFile, draft: Draft[CellTable], names: Names) -> None:
    """Check that the names in a cell.toml follow the language's rules and are unique in their group. The
    groups are the frames, the bodies (with zones and start zones), and the names of joint positions and
    signals.
    """
    from yarclang.cell.frames import FROM_THE_ROBOT

    first: dict[tuple[str, str], str] = {}
    for path, name in _named(draft.table):
        key, upper = str(path[0]), name.upper()
        what = _WHAT[key]
        space = (
            key
            if key == "frames"
            else "bodies"
            if key in ("obstacles", "zones", "parts", "tools", "starts")
            else "names"
        )
        at_key = space != "bodies"
        if not _NAME.fullmatch(upper):
            message = f'The {what} has the name "{name[:40]}", which a program can\'t write.'
            file.say(
                "Y1310", path, message, "Use ASCII letters, digits and _, not a digit first.", at_key=at_key
            )
        elif space == "names" and names.is_word(upper):
            message = f"{name[:40]} is a word of the language, and can't be the name of an {what}."
            file.say(
                "Y1310", path, message.replace("an joint", "a joint"), "Choose another name.", at_key=True
            )
        elif space == "frames" and upper in FROM_THE_ROBOT:
            message = f"The frame {{{upper}}} comes from the robot, and can't be declared."
            file.say("Y1310", path, message, "Choose another name.", at_key=True)
        elif (space, upper) in first:
            other = first[space, upper]
            message = f"{name} is already used for the {other}; upper and lower case make no difference."
            file.say("Y1311", path, message, "Give one of the two another name.", at_key=at_key)
        first.setdefault((space, upper), f"{what} {name} in line {file.places.of_key(path).line}")


def _named(table: CellTable) -> Iterator[tuple[Path, str]]:
    """Yield the path and the name of each named entry in a cell.toml, in the order of the tables in the
    file.
    """
    for key in ("frames", "joints", "inputs", "outputs"):
        yield from (((key, name), name) for name in getattr(table, key))
    for key in ("obstacles", "zones", "parts", "tools", "starts"):
        for at, entry in enumerate(getattr(table, key)):
            if entry.name is not None:
                yield (key, at, "name"), entry.name


def _places(file: TomlFile, table: CellTable, *, is_locked: bool) -> Mapping[tuple[str, str], Span]:
    """Return the places of the names that programs can use."""
    places = {
        (str(path[0]), name.upper()): file.places.of_key(path)
        for path, name in _named(table)
        if len(path) == 2
    }
    places.update(
        (("tools", name.upper()), file.places.of_value(path))
        for path, name in _named(table)
        if path[0] == "tools" and is_locked
    )
    return places


def _zone_places(file: TomlFile, table: CellTable) -> dict[str, Span]:
    """Return the places of the names of zones."""
    return {
        zone.name.upper(): file.places.of_value(("zones", at, "name"))
        for at, zone in enumerate(table.zones)
        if zone.name is not None
    }


def _rule_places(file: TomlFile, rules: Mapping[str, tuple[Zone, int]]) -> dict[str, Span]:
    """Return the places of the rules of `[[keep]]`, by the names of their zones."""
    return {name: file.places.of_key(("keep", at)) for name, (_, at) in rules.items()}
