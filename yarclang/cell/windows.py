"""Read joint values of a cell for a robot: named joint positions, and windows of zones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from yarclang.cell.measures import Measures
from yarclang.cell.model import Array, JointWindow
from yarclang.robot.joint_names import numbers_by_name
from yarclang.robot.model import Robot
from yarclang.toml.draft import spoken
from yarclang.toml.file import did_you_mean, right_length
from yarclang.toml.places import Path
from yarclang.transforms import constant
from yarclang.units import Kind, Unit

Units = Mapping[Kind, Unit] | None


def joint_position(
    name: str, values: Sequence[float], path: Path, units: Units, measures: Measures, robot: Robot | None
) -> Array | None:
    """Read a joint position (n,) [rad or m], and check it against the limits of the robot. Return None if the
    entry is wrong, which is reported, or if no robot is given.

    Without a robot, the only check is that a unit of angle or of length is stated.
    """
    if robot is None:
        if units is not None and not units.keys() & {"angle", "length"}:
            measures.factor(units, "angle", path)
        return None
    if not right_length(measures.file, path, values, robot.size, "value", "joint"):
        return None
    factors = [measures.factor(units, kind, path) for kind in dict.fromkeys(_kinds(robot))]
    if units is None or None in factors:
        return None
    q = np.array(values) * [units[kind].factor for kind in _kinds(robot)]
    excess = np.maximum(robot.limits.lower - q, q - robot.limits.upper) / robot.axis_units
    joint = int(np.argmax(excess))
    if excess[joint] <= 1e-9:
        return constant(q)
    unit, scale = robot.axis_unit_names[joint], robot.axis_units[joint]
    lower, upper = robot.limits.lower[joint] / scale, robot.limits.upper[joint] / scale
    message = (
        f"{name} has joint {robot.joint_names[joint]} at {q[joint] / scale:.6g} {unit}, {excess[joint]:.6g} "
        f"{unit} outside its limits {lower:g} to {upper:g}."
    )
    measures.file.say(
        "Y1317", (*path, joint), message, f"Change the position, or remove it for {robot.name}."
    )
    return None


def joint_window(
    joints: Mapping[str, Sequence[float]], path: Path, units: Units, measures: Measures, robot: Robot | None
) -> JointWindow | None:
    """Return the joint window of a zone. Report a wrong entry. Return None if the entry is wrong, or if no
    robot is given.
    """
    sound = bool(joints)
    if not joints:
        measures.file.say("Y1308", path, "The joint window names no joint.", "Write { J1 = [-90, 90] }.")
    for name, ends in joints.items():
        if not measures.sized(ends, 2, (*path, name)):
            sound = False
        elif ends[0] >= ends[1]:
            message = (
                f"{spoken((*path, name))} begins at {ends[0]:g}, which must be below its end, {ends[1]:g}."
            )
            measures.file.say("Y1316", (*path, name), message, "Write [least, largest].")
            sound = False
    if robot is None or units is None:
        return None
    lower, upper = np.full(robot.size, -np.inf), np.full(robot.size, np.inf)
    known = numbers_by_name(robot.joint_names)
    named: dict[int, str] = {}
    for name, ends in joints.items():
        at = known.get(name.upper())
        if at is None:
            message = f"{robot.name} has no joint {name[:40]}."
            measures.file.say(
                "Y1372", (*path, name), message, *did_you_mean(name.upper(), known), at_key=True
            )
            sound = False
            continue
        if at in named:
            message = (
                f"The window names joint {robot.joint_names[at]} twice: {named[at][:40]} and {name[:40]}."
            )
            measures.file.say("Y1372", (*path, name), message, "Remove one of them.", at_key=True)
            sound = False
            continue
        named[at] = name
        factor = measures.factor(units, _kinds(robot)[at], (*path, name))
        if factor is None:
            sound = False
        elif sound:
            lower[at], upper[at] = np.array(ends) * factor
    return JointWindow(constant(lower), constant(upper)) if sound else None


def _kinds(robot: Robot) -> tuple[Kind, ...]:
    return tuple("length" if unit == "mm" else "angle" for unit in robot.axis_unit_names)
