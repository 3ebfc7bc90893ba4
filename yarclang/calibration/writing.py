"""What was calibrated, as text: a FRAME line of a program, and values of a robot.toml."""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array
from yarclang.source import SourceFile
from yarclang.toml.places import find_places
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM


def frame_line(name: str, pose: Array, parent: str) -> str:
    """`FRAME {NAME} x y z roll pitch yaw (mm,deg) {PARENT}` of a pose (4, 4) in the parent [m], to 1 um and 0.0001 deg."""
    values = [*_printed(pose[:3, 3] / MM, 3), *_printed(roll_pitch_yaw(pose[:3, :3]) / DEG, 4)]
    return f"FRAME {{{name}}} {' '.join(values)} (mm,deg) {{{parent}}}"


def with_offsets(robot_toml: SourceFile, offsets: Array) -> str:
    """The text of a robot.toml with these offsets a0 (n,) [counts], rounded to 0.01 count; all else stays as it is."""
    return _with_value(robot_toml, "actuation", "a0", f"[{', '.join(_printed(offsets, 2))}]")


def with_tip(robot_toml: SourceFile, name: str, flange_from_tip: Array) -> str:
    """The text of a robot.toml in which the frame `name` on the flange has its origin here (3,) [m], to 1 um.

    A frame that the file has keeps its orientation; a new one has that of the flange.
    """
    xyz = f"[{', '.join(_printed(flange_from_tip / MM, 3))}]"
    if ("frames", name) in find_places(robot_toml).keys:
        return _with_value(robot_toml, f"frames.{name}", "xyz", xyz)
    text = robot_toml.text if robot_toml.text.endswith("\n") else robot_toml.text + "\n"
    return f'{text}\n[frames.{name}]\nparent = "FLANGE"\nxyz = {xyz}  # mm\nrpy = [0, 0, 0]  # deg\n'


def _with_value(file: SourceFile, table: str, key: str, value: str) -> str:
    """The text with another value of a table's key, or with the key, right below the table's header, where it isn't there."""
    places = find_places(file)
    path = tuple(table.split("."))
    lines = file.text.split("\n")  # a carriage return stays at its line's end
    if span := places.values.get((*path, key)):
        behind = lines[span.end_line - 1][span.end_column - 1 :]
        lines[span.line - 1 : span.end_line] = [lines[span.line - 1][: span.column - 1] + value + behind]
    else:
        header = places.keys[path].line
        lines.insert(header, f"{key} = {value}" + "\r" * lines[header - 1].endswith("\r"))
    return "\n".join(lines)


def _printed(values: Array, decimals: int) -> list[str]:
    """The numbers without needless zeros, and without a minus before a zero."""
    return [f"{value:.{decimals}f}".rstrip("0").rstrip(".") for value in np.round(values, decimals) + 0.0]
