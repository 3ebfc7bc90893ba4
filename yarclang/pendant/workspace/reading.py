"""Contents of a cell.toml and a robot.toml for the workspace page. The functions wait for the disk."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from yarclang.cell.description import Names, read_cell
from yarclang.cell.measures import Measures
from yarclang.cell.model import PARTS, Array, Cell
from yarclang.coordinator.messages.findings import Finding, finding_messages
from yarclang.coordinator.messages.message import LARGEST
from yarclang.diagnostics import Diagnostic
from yarclang.pendant.messages.workspace import (
    EntryValues,
    JointLimits,
    Table,
    WorkspaceEntry,
    WorkspaceFrame,
)
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.robot.description import read_robot
from yarclang.robot.model import Robot
from yarclang.robot.urdf import read_urdf
from yarclang.runtime.actions import Trouble
from yarclang.semantics.declared.meanings import is_word
from yarclang.source import SourceFile
from yarclang.toml.file import TomlFile
from yarclang.toml.places import Path as TomlPath
from yarclang.toml.places import Places, find_places
from yarclang.toml.reading import read_text
from yarclang.units import Kind, Unit

_TABLES: tuple[Table, ...] = ("obstacles", "zones")
_MARK = "\ufeff"


@dataclass(frozen=True, slots=True)
class Text:
    """A text file of the project.

    Attributes:
        file: path in the project.
        path: absolute path.
        text: content of the file, without the byte order mark.
        mark: the byte order mark; empty if there is none.
        known: SHA-256 of the file, from which a later change is recognized.
    """

    file: str
    path: Path
    text: str
    mark: str
    known: str

    @property
    def source(self) -> SourceFile:
        """Content of the file as a source named by its path in the project."""
        return SourceFile(self.file, self.text)

    @property
    def placed(self) -> SourceFile:
        """Content of the file as a source named by its absolute path."""
        return SourceFile(str(self.path), self.text)


def text_in(folder: ProjectFolder, path: Path) -> Text:
    """Read a text file, which must be in the project.

    Raises:
        Trouble: the file is outside of the project, doesn't exist, or isn't text.
    """
    inside = folder.path(str(path.absolute()))
    file = inside.relative_to(folder.root).as_posix()
    content, status = folder.read(file)
    try:
        text = content.decode()
    except UnicodeDecodeError:
        raise Trouble(f"{file} is not UTF-8 text", "save it as UTF-8 text", "Y1302") from None
    mark = _MARK if text.startswith(_MARK) else ""
    return Text(file, inside, text.removeprefix(_MARK), mark, status.sha256)


def cell_of(text: SourceFile, folder: Path, robot: Robot) -> tuple[Cell | None, tuple[Diagnostic, ...]]:
    """Return the cell that a text describes, and all of its findings."""
    made = read_cell(text, folder, Names(is_word, robot))
    return made.value, made.diagnostics


def entries_of(text: SourceFile) -> tuple[WorkspaceEntry, ...]:
    """Return the zones and obstacles of a text, without entries that aren't tables."""
    data = _data(text)
    if data is None:
        return ()
    places = find_places(text)
    measures = Measures(TomlFile(text, places))
    measures.read_common(_word(data.get("units")))
    entries_found = []
    for table in _TABLES:
        entries = data.get(table)
        for at, entry in enumerate(entries if isinstance(entries, list) else ()):
            if isinstance(entry, dict):
                units = measures.of_entry(_word(entry.get("units")), (table, at)) or {}
                entries_found.append(_entry(table, at, entry, units, places))
    return tuple(entries_found)


def units_of(text: SourceFile) -> Mapping[Kind, Unit]:
    """Return the units that are declared at the top of a cell.toml."""
    data = _data(text) or {}
    measures = Measures(TomlFile(text, find_places(text)))
    measures.read_common(_word(data.get("units")))
    return measures.common


def frames_of(cell: Cell | None) -> tuple[WorkspaceFrame, ...]:
    """Return the frames in which bodies can be placed."""
    still = WorkspaceFrame(name="B", on_flange=False, pose=_rows(np.eye(4)))
    carried = WorkspaceFrame(name="FLANGE", on_flange=True, pose=_rows(np.eye(4)))
    cell_frames = () if cell is None else cell.frames.values()
    return (
        still,
        carried,
        *(
            WorkspaceFrame(name=one.name, on_flange=one.mount.on_flange, pose=_rows(one.mount.transform))
            for one in cell_frames
        ),
    )


def watched_of(robot: Robot) -> tuple[str, ...]:
    """Return the bodies that a zone can watch: parts, and links with shapes."""
    return (*PARTS, *dict.fromkeys(one.link for one in robot.shapes))


def limits_of(text: str, robot: Robot) -> tuple[JointLimits, ...]:
    """Return the position limits of each joint, both from the text of a robot.toml and from the URDF."""
    try:
        tables = tomllib.loads(text).get("joints", {})
    except (tomllib.TOMLDecodeError, RecursionError):
        return ()
    allowed = _of_urdf(robot)
    limits_found = []
    for at, name in enumerate(robot.joint_names):
        table = tables.get(name) if isinstance(tables, dict) else None
        position = table.get("position") if isinstance(table, dict) else None
        from_toml = _pair(position)
        least, largest = allowed.get(name, (None, None))
        limits_found.append(
            JointLimits(
                name=name,
                unit=robot.axis_unit_names[at],
                lower=from_toml[0],
                upper=from_toml[1],
                least=least,
                largest=largest,
            )
        )
    return tuple(limits_found)


def findings_of(diagnostics: tuple[Diagnostic, ...]) -> tuple[Finding, ...]:
    """Return findings as messages, at most as many as a page shows."""
    return finding_messages(diagnostics[:100])


def checked_robot(text: SourceFile, folder: Path) -> tuple[Robot | None, tuple[Diagnostic, ...]]:
    """Return the robot that a robot.toml's text describes, and all of its findings."""
    made = read_robot(text, folder)
    return made.value, made.diagnostics


def _of_urdf(robot: Robot) -> dict[str, tuple[float | None, float | None]]:
    """Return the position limits in a robot's URDF, by joint [deg or mm]. Joints without valid limits are
    left out.
    """
    limits_found: dict[str, tuple[float | None, float | None]] = {}
    source = read_text(robot.folder / robot.urdf, "")
    if isinstance(source, Diagnostic):
        return limits_found
    for joint in read_urdf(source).joints.values():
        if joint.name in robot.joint_names and joint.kind != "continuous":
            unit = float(robot.axis_units[robot.joint_names.index(joint.name)])
            if joint.lower is not None and joint.upper is not None and joint.lower < joint.upper:
                limits_found[joint.name] = (round(joint.lower / unit, 3), round(joint.upper / unit, 3))
    return limits_found


def _entry(
    table: Table, at: int, entry: dict[str, Any], units: Mapping[Kind, Unit], places: Places
) -> WorkspaceEntry:
    values = {key: value for key, value in entry.items() if key in EntryValues.model_fields}
    path: TomlPath = (table, at)
    length, angle = units.get("length"), units.get("angle")
    time = units.get("time")
    return WorkspaceEntry(
        table=table,
        at=at,
        line=places.of_key(path).line,
        values=_values(values),
        metre=None if length is None else length.factor,
        radian=None if angle is None else angle.factor,
        length_unit="" if length is None else length.name,
        angle_unit="" if angle is None else angle.name,
        speed_unit=f"{length.name}/{time.name}" if length is not None and time is not None else "",
    )


def _values(values: dict[str, Any]) -> EntryValues:
    """Return the values of an entry (zone or obstacle) by key. Keys whose values have a wrong type are
    left out, because the findings report them.
    """
    while True:
        try:
            return EntryValues.model_validate_json(json.dumps(values, default=str))
        except (ValidationError, ValueError) as error:
            bad = {str(one["loc"][0]) for one in error.errors() if one["loc"]} if isinstance(error,
                ValidationError) else set(values)  # fmt: skip
            values = {key: value for key, value in values.items() if key not in bad}
            if not bad:
                return EntryValues()


def _data(text: SourceFile) -> dict[str, Any] | None:
    try:
        return tomllib.loads(text.text)
    except (tomllib.TOMLDecodeError, RecursionError):
        return None


def _pair(value: object) -> tuple[float | None, float | None]:
    """Return two numbers; (None, None) if the value isn't a pair of numbers."""
    if not isinstance(value, list) or len(value) != 2:
        return None, None
    if not all(type(one) in (int, float) and abs(one) <= LARGEST for one in value):
        return None, None
    return float(value[0]), float(value[1])


def _word(value: object) -> str | None:
    return value if isinstance(value, str) else None


def _rows(pose: Array) -> tuple[float, ...]:
    return tuple(np.round(pose[:3], 7).ravel().tolist())
