"""Read the tools of a cell that the robot changes: their places in the rack, and the lock of the changer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from yarclang.cell.bodies import Surroundings, mounted
from yarclang.cell.frames import ROOTS
from yarclang.cell.model import CellOutput, Grip, Mount, Obstacle, Part, RackTool, Weight
from yarclang.cell.schema import CellTable, OutputTable, RackTable
from yarclang.robot.model import Robot, Tool
from yarclang.toml.file import did_you_mean
from yarclang.toml.places import Path
from yarclang.transforms import constant

NO_TOOL = "NONE"
"""Word that a program writes in place of a tool's name to leave the flange empty after the change."""

LOCK_REACH = 0.0005
"""Largest distance of the flange from a tool's place at which a changer locks [m], if the file doesn't set
it.
"""

MOST_REACH = 0.005
"""Largest distance that a file may set in place of `LOCK_REACH` [m]. A changer pulls the tool over this
distance, and this pull isn't modelled.
"""


def read_lock(table: OutputTable, path: Path, around: Surroundings) -> Grip | None:
    """Return the tool changer's lock that an output moves. Report a wrong entry, and return None for it."""
    file = around.measures.file
    for key in ("grips", "grips_at", "removes", "removes_at", "tool"):
        if getattr(table, key) is not None:
            message = (
                f"The output {path[-1]} has locks_at and {key}: the lock of a tool changer holds tools, not "
                "parts."
            )
            file.say("Y1305", (*path, key), message, "Remove one of them.", at_key=True)
            return None
    assert table.locks_at is not None  # this key makes the output a lock
    reach = LOCK_REACH
    if table.reach is not None:
        factor = around.measures.factor(around.measures.common, "length", (*path, "reach"))
        if factor is None:
            return None
        reach = table.reach * factor
    if not 0.0 < reach <= MOST_REACH:
        message = (
            f"The lock {path[-1]} reaches {reach * 1e3:.4g} mm; it must be more than 0 and at most "
            f"{MOST_REACH * 1e3:g} mm."
        )
        file.say(
            "Y1308",
            (*path, "reach"),
            message,
            "Tools are docked exactly: teach their places more accurately.",
        )
        return None
    if table.safe is not None and table.safe != table.locks_at:
        message = f"The lock {path[-1]} has a safe value that opens it at each stop and drops the tool."
        file.say("Y1378", (*path, "safe"), message, "Remove safe: the output then keeps its value at a stop.")
        return None
    return Grip("FLANGE", ROOTS["FLANGE"].transform, reach, table.locks_at, changes=True)


def tool_of(name: str, path: Path, around: Surroundings) -> str | None:
    """Return the name, in upper case, of a changeable tool. Report a wrong name, and return None for it."""
    if name.upper() in around.tools:
        return name.upper()
    message = f"tool is {name[:40]}, which isn't one of the [[tools]] of this file."
    remedy, subject = did_you_mean(name.upper(), around.tools)
    remedy = remedy if around.tools else "Declare it under [[tools]], or remove tool."
    around.measures.file.say("Y1378", path, message, remedy, subject)
    return None


def own_frame(name: str, table: OutputTable, around: Surroundings) -> Mount | None:
    """Return the pose of a frame of the robot, for an output that moves a gripper of a changeable tool. Only
    such an output may name a frame of robot.toml.

    Return None for other outputs and for unknown frames. Without a robot, any frame that the cell doesn't
    declare is assumed to be the robot's.
    """
    robot = around.robot
    if table.tool is None or name.upper() in around.names:
        return None
    if robot is None:  # any frame may be the robot's
        return ROOTS["FLANGE"]
    placed = robot.flange_from_frame.get(name.upper())
    return None if placed is None else Mount(placed, True)


def read_tools(
    table: CellTable, outputs: Mapping[str, CellOutput], around: Surroundings
) -> list[Part | None]:
    """Return the changeable tools of a cell.toml, in the form of workpieces. Report wrong entries; the list
    has None in the place of each.

    Args:
        table: data of the file.
        outputs: outputs of the cell, by name in upper case.
        around: units, frames, the robot, and findings.
    """
    file = around.measures.file
    locks = [name for name, one in outputs.items() if one.grip is not None and one.grip.changes]
    for name in locks[1:]:
        place: Path = ("outputs", next(one for one in table.outputs if one.upper() == name), "locks_at")
        message = f"{locks[0]} and {name} are both locks of a tool changer: a robot can have only one."
        file.say("Y1378", place, message, "Remove locks_at from one of them.", at_key=True)
    tried = any(one.locks_at is not None for one in table.outputs.values())
    if table.tools and not tried:
        message = "The file has tools to change, but no output that locks them."
        file.say(
            "Y1378",
            ("tools", 0),
            message,
            'Write locks_at = "ON" under the output of the changer, in [outputs].',
        )
    on = [at for at, one in enumerate(table.tools) if one.on]
    for at in on[1:]:
        message = (
            f"{table.tools[at].name} and {table.tools[on[0]].name} are both on the flange when a program "
            "starts."
        )
        file.say("Y1378", ("tools", at, "on"), message, "Keep on = true at only one of them.")
    lock = outputs[locks[0]] if locks else None
    return [_read_tool(one, ("tools", at), lock, outputs, around) for at, one in enumerate(table.tools)]


def _read_tool(
    table: RackTable,
    path: Path,
    lock: CellOutput | None,
    outputs: Mapping[str, CellOutput],
    around: Surroundings,
) -> Part | None:
    measures, robot = around.measures, around.robot
    units = measures.of_entry(table.units, path)
    place = mounted(table, path, units, around)
    margin = measures.factor(units, "length", (*path, "margin")) if table.margin else 1.0
    if place is not None and place.on_flange:
        message = f"The place of {table.name} is fixed to {table.frame}, which the robot carries."
        measures.file.say("Y1374", (*path, "frame"), message, "Name B, or a frame that is fixed to B.")
        return None
    if table.name is None or robot is None:
        return None
    tool = _tool_named(table.name, path, around, robot)
    frames = None if tool is None else _frames_of(table, path, tool, around, robot)
    if tool is None or frames is None or place is None or margin is None:
        return None
    if lock is None or lock.grip is None:
        return None
    own = tuple(
        one.variable for one in outputs.values() if one.grip is not None and one.grip.tool == tool.name
    )
    first = tool.shapes[0]
    back = np.linalg.inv(first.flange_from_shape)
    more = tuple((constant(back @ one.flange_from_shape), one.shape) for one in tool.shapes[1:])
    rack = RackTool(place, first.flange_from_shape, more, frames, lock.variable, own, lock.grip.reach)
    mount = Mount(first.flange_from_shape, True) if table.on else Mount(constant(rack.base_from_body), False)
    body = Obstacle(
        tool.name,
        first.shape,
        mount,
        table.margin * margin,
        mass=tool.mass or None,
        is_part=True,
        of_tool=True,
        weight=weight_of(tool),
    )
    return Part(body, rack=rack)


def weight_of(tool: Tool) -> Weight:
    """Return the distribution of a tool's mass in the frame of its first body."""
    body_from_flange = np.linalg.inv(tool.shapes[0].flange_from_shape)
    turn = body_from_flange[:3, :3]
    center = turn @ tool.center + body_from_flange[:3, 3]
    return Weight(constant(center), constant(turn @ tool.inertia @ turn.T))


def _tool_named(name: str, path: Path, around: Surroundings, robot: Robot) -> Tool | None:
    file = around.measures.file
    tool = next((one for one in robot.tools if one.name == name.upper()), None)
    if name.upper() == NO_TOOL:
        message = f"A tool can't be called {NO_TOOL}: TOOL {NO_TOOL} puts the tool back."
        file.say("Y1310", (*path, "name"), message, "Choose another name, in robot.toml too.")
    elif tool is None:
        known = [one.name for one in robot.tools]
        message = f"{name[:40]} isn't a tool of {robot.name}."
        remedy, subject = did_you_mean(name.upper(), known)
        remedy = (
            remedy if known else f"Describe it in robot.toml: [tools.{name[:40].upper()}], mounted = false."
        )
        file.say("Y1378", (*path, "name"), message, remedy, subject)
    elif tool.mounted:
        message = f"{tool.name} is always on the flange of {robot.name}: robot.toml has it mounted."
        file.say("Y1378", (*path, "name"), message, "Write mounted = false there: the cell gives its place.")
    elif not tool.shapes:
        message = f"{tool.name} has no body in robot.toml: its place would be empty."
        file.say("Y1378", (*path, "name"), message, "Add its shapes there, under [[bodies]].")
    else:
        return tool
    return None


def _frames_of(
    table: RackTable, path: Path, tool: Tool, around: Surroundings, robot: Robot
) -> tuple[str, ...] | None:
    """Return the names of the frames on the flange that exist only while a tool is on the flange. Report a
    wrong entry, and return None for it.
    """
    own = {*_own_frame(tool)}
    hanging = {name for name, one in around.frames.items() if one.mount.on_flange}
    known = (hanging | {*robot.flange_from_frame}) - {"FLANGE"}
    for at, name in enumerate(table.frames or ()):
        if name.upper() not in known:
            message = f"{name[:40]} is no frame on the flange."
            remedy, subject = did_you_mean(name.upper(), known)
            around.measures.file.say("Y1378", (*path, "frames", at), message, remedy, subject)
            return None
        own.add(name.upper())
    return tuple(sorted(own))


def _own_frame(tool: Tool) -> Iterator[str]:
    if tool.frame != "FLANGE":
        yield tool.frame
