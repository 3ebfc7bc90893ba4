"""Read the sensors of a cell: for each sensor, the input that it sets, and its region."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from yarclang.cell.bodies import Surroundings, Units, belong, mounted
from yarclang.cell.model import Array, CellOutput, Mount, Sensor
from yarclang.cell.schema import SensorTable
from yarclang.shapes import Capsule, Sphere
from yarclang.toml.file import did_you_mean
from yarclang.toml.places import Path
from yarclang.transforms import constant

_KINDS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "beam": (("frame", "to"), ("xyz",)),
    "proximity": (("frame", "range"), ("xyz",)),
    "vacuum": (("gripper",), ()),
}
"""The required and the optional keys of each kind of sensor."""

_OF_KINDS = ("frame", "xyz", "rpy", "quat", "to", "range", "gripper")

_BEAM = 0.0005
"""Radius of a light beam [m]."""


def read_sensor(
    table: SensorTable,
    path: Path,
    around: Surroundings,
    inputs: Mapping[str, str],
    outputs: Mapping[str, CellOutput],
) -> Sensor | None:
    """Read a sensor of a cell.toml. Report mistakes, and return None if there are any.

    Args:
        table: table of the sensor.
        path: path of the table in the file.
        around: units, frames and findings.
        inputs: the controller's variables of the cell's inputs, by their names in upper case.
        outputs: the cell's outputs, by their names in upper case.
    """
    if table.kind is None or table.input is None:
        return None
    needed, optional = _KINDS[table.kind]
    sound = belong(table, path, table.kind, needed, _OF_KINDS, around, optional)
    variable = inputs.get(table.input.upper())
    if variable is None:
        message = f"The sensor drives {table.input[:40]}, which isn't an input of this file."
        around.measures.file.say(
            "Y1375", (*path, "input"), message, *did_you_mean(table.input.upper(), inputs)
        )
        sound = False
    if not sound or variable is None:
        return None
    if table.kind == "vacuum":
        return _vacuum(table, path, variable, around, outputs)
    units = around.measures.of_entry(table.units, path)
    mount = mounted(table, path, units, around)
    if mount is None:
        return None
    if table.range is not None:
        unit = around.measures.factor(units, "length", (*path, "range"))
        return None if unit is None else Sensor(variable, table.inverted, Sphere(table.range * unit), mount)
    return _beam(table, path, variable, mount, units, around)


def _vacuum(
    table: SensorTable, path: Path, variable: str, around: Surroundings, outputs: Mapping[str, CellOutput]
) -> Sensor | None:
    name = str(table.gripper)
    output = outputs.get(name.upper())
    if output is None or output.grip is None:
        message = f"The sensor watches {name[:40]}, which isn't an output with a gripper."
        grippers = [each for each, one in outputs.items() if one.grip is not None]
        remedy, subject = did_you_mean(name.upper(), grippers)
        remedy = remedy if grippers else 'Give an output grips = "GRIPPER".'
        around.measures.file.say("Y1375", (*path, "gripper"), message, remedy, subject)
        return None
    return Sensor(variable, table.inverted, gripper=output.variable)


def _beam(
    table: SensorTable, path: Path, variable: str, mount: Mount, units: Units, around: Surroundings
) -> Sensor | None:
    """Return a light beam as a thin straight body from the point `xyz` to the point `to`, both in the
    sensor's frame. Report a wrong entry, and return None for it.
    """
    measures = around.measures
    unit = measures.factor(units, "length", (*path, "to"))
    if unit is None or table.to is None or not measures.sized(table.to, 3, (*path, "to")):
        return None
    begin = np.zeros(3) if table.xyz is None else np.array(table.xyz) * unit
    way: Array = np.array(table.to) * unit - begin
    length = float(np.linalg.norm(way))
    if length < 1e-6:
        message = "The beam has no length: it ends where it begins."
        measures.file.say("Y1308", (*path, "to"), message, "Write the place of its receiver.")
        return None
    return Sensor(
        variable, table.inverted, Capsule(_BEAM, length), Mount(_along(mount, way), mount.on_flange)
    )


def _along(mount: Mount, way: Array) -> Array:
    """Return the pose (4, 4) at the middle of a vector (3,) [m] that begins at a mount, with the z axis along
    the vector.
    """
    z = way / np.linalg.norm(way)
    x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x /= np.linalg.norm(x)
    placed = np.eye(4)
    placed[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    placed[:3, 3] = way / 2.0
    return constant(mount.transform @ placed)
