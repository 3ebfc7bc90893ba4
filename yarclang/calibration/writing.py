"""Write calibration results as text: as a FRAME line of a program, or as values of a robot.toml or
cell.toml.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator

import numpy as np

from yarclang.robot.model import Array
from yarclang.source import SourceFile
from yarclang.toml.changes import printed, with_table, with_value, without
from yarclang.toml.places import Path, find_places
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM, UNITS, Unit


def frame_line(name: str, pose: Array, parent: str) -> str:
    """Return the line `FRAME {NAME} x y z roll pitch yaw (mm,deg) {PARENT}`, rounded to 1 um and 0.0001 deg.

    Args:
        name: name of the frame.
        pose: (4, 4) pose of the frame in the parent [m].
        parent: name of the parent.
    """
    values = [*_printed(pose[:3, 3] / MM, 3), *_printed(roll_pitch_yaw(pose[:3, :3]) / DEG, 4)]
    return f"FRAME {{{name}}} {' '.join(values)} (mm,deg) {{{parent}}}"


def with_offsets(robot_toml: SourceFile, offsets: Array) -> str:
    """Return the text of a robot.toml with new offsets a0 (n,) [counts], rounded to 0.01 count."""
    return with_value(robot_toml, ("actuation", "a0"), _rounded(offsets, 2))


def with_tip(robot_toml: SourceFile, name: str, flange_from_tip: Array) -> str:
    """Return the text of a robot.toml in which a frame on the flange has a new origin, rounded to 1 um.

    A frame that is already in the file keeps its orientation. A new frame has the orientation of the flange.

    Args:
        robot_toml: text of the file.
        name: name of the frame.
        flange_from_tip: (3,) origin of the frame in {FLANGE} [m].
    """
    xyz = _rounded(flange_from_tip / MM, 3)
    if ("frames", name) in find_places(robot_toml).keys:
        return with_value(robot_toml, ("frames", name, "xyz"), xyz)
    end = "\r\n" if "\r\n" in robot_toml.text else "\n"
    text = robot_toml.text if robot_toml.text.endswith("\n") else robot_toml.text + end
    rows = (
        "",
        f"[frames.{name}]",
        'parent = "FLANGE"',
        f"xyz = {printed(xyz)}  # mm",
        "rpy = [0, 0, 0]  # deg",
        "",
    )
    return text + end.join(rows)


def with_frame(cell_toml: SourceFile, name: str, parent_from_frame: Array, parent: str) -> str:
    """Return the text of a cell.toml in which a frame has a new pose, in the units of the frame's table. The
    pose is rounded to 1 um and 0.0001 deg.

    Args:
        cell_toml: a text that tomllib accepts.
        name: name of the frame, as the file spells it. A frame that is already in the file keeps its
            parent.
        parent_from_frame: (4, 4) pose of the frame in its parent [m].
        parent: parent of a new frame.

    Raises:
        ChangeError: the file is written in a form that doesn't allow the change.
    """
    path: Path = ("frames", name)
    data = tomllib.loads(cell_toml.text)
    tables = data.get("frames", {})
    table = tables.get(name) if isinstance(tables, dict) else None
    own = table.get("units") if isinstance(table, dict) else None
    units = {one.kind: one for text in (data.get("units"), own) for one in _units(text)}
    if not {"length", "angle"} <= units.keys():
        own, units = "mm,deg", {one.kind: one for one in _units("mm,deg")}
        values: dict[str, object] = {"units": own}
    else:
        values = {}
    length, angle = units["length"].factor, units["angle"].factor
    values["xyz"] = _rounded(parent_from_frame[:3, 3] / length, _digits(length, _LENGTH))
    values["rpy"] = _rounded(roll_pitch_yaw(parent_from_frame[:3, :3]) / angle, _digits(angle, _ANGLE))
    if table is None:
        return with_table(cell_toml, path, {"parent": parent, **values})
    text = cell_toml.text
    if isinstance(table, dict) and "quat" in table:
        text = without(cell_toml, (*path, "quat"))
    for key, value in values.items():
        text = with_value(SourceFile(cell_toml.name, text), (*path, key), value)
    return text


_LENGTH, _ANGLE = 1e-6, 2e-6
"""Approximate steps to which written lengths [m] and angles [rad] are rounded."""


def _units(text: object) -> Iterator[Unit]:
    for name in text.split(",") if isinstance(text, str) else ():
        unit = UNITS.get(name.strip().lower())
        if unit is not None:
            yield unit


def _digits(factor: float, step: float) -> int:
    """Return the number of decimals that a printed value needs for a given resolution.

    Args:
        factor: size of the value's unit [m or rad].
        step: the resolution [m or rad].
    """
    return max(0, math.ceil(math.log10(factor / step) - 1e-9))


def _rounded(values: Array, decimals: int) -> list[float]:
    rounded: list[float] = (np.round(values, decimals) + 0.0).tolist()
    return rounded


def _printed(values: Array, decimals: int) -> list[str]:
    """Return numbers as texts, without trailing zeros, and without a minus sign before zero."""
    return [f"{value:.{decimals}f}".rstrip("0").rstrip(".") for value in np.round(values, decimals) + 0.0]
