"""Check the values of a robot.toml against each other and against the URDF. The type and unit of each single
value are checked in schema.py.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from yarclang.robot.drive_checks import check_drives
from yarclang.robot.urdf import Joint, Urdf
from yarclang.subjects import Name
from yarclang.toml.circles import circles
from yarclang.toml.file import TomlFile, did_you_mean, right_length
from yarclang.toml.places import Path
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.robot.draft import RobotDraft
    from yarclang.robot.schema import JointTable


MOST_JOINTS = 9
RESERVED = ("B", "FLANGE")
"""Names of the frames at both ends of every robot's chain, base and flange. No other frame may have these
names.
"""
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_INDEX = re.compile(r"[Pp]\d+")


def check_table(file: TomlFile, draft: RobotDraft, chain: Sequence[Joint] | None) -> None:
    """Report all findings about the values of a robot.toml.

    Args:
        file: the robot.toml, which collects the findings.
        draft: its tables.
        chain: the moving joints from the base to the flange, or None if the URDF has errors.
    """
    names = _check_joints(file, draft, chain)
    _check_names(file, draft)
    _check_frames(file, draft)
    if names is None:
        return
    size = len(names) if chain is not None else _likely_size(draft, len(names))
    if size == len(names):
        _check_positions(file, draft, names, {joint.name: joint.kind for joint in chain or ()})
    check_drives(file, draft, size)


def _likely_size(draft: RobotDraft, tables: int) -> int:
    """Return the probable number of joints of a robot.toml whose URDF has errors.

    Several lists of robot.toml have one entry for each joint. The result is the most frequent length of these
    lists.
    """
    actuation, motors, controller = draft.table.actuation, draft.table.motors, draft.table.controller
    lists: list[Sequence[object] | None] = []
    lists += [actuation.K, actuation.J, actuation.a0] if actuation else []
    lists += [motors.numbers, motors.velocity] if motors else []
    lists += [value for _, value in controller if isinstance(value, list)] if controller else []
    sizes = [tables, *(len(values) for values in lists if values is not None)]
    return max(sizes, key=sizes.count)


def _check_joints(file: TomlFile, draft: RobotDraft, chain: Sequence[Joint] | None) -> tuple[str, ...] | None:
    """Check the tables [joints.NAME] of robot.toml.

    Returns:
        The joints' names: in the order of the kinematic chain, or in the order of the tables if the chain
        isn't known. None if neither the chain nor the tables can be read.
    """
    tables: Mapping[str, JointTable] = draft.table.joints or {}
    kinds = {joint.name: joint.kind for joint in chain or ()}
    for name, table in tables.items():
        _check_joint(file, draft, name, table, kinds.get(name, "revolute" if chain is None else ""))
    if ("joints",) in draft.dropped or draft.table.joints is None:
        return tuple(kinds) if chain is not None else None
    listed = list(tables) + [str(path[1]) for path in draft.dropped if path[0] == "joints" and len(path) == 2]
    names = tuple(kinds) if chain is not None else tuple(listed)
    if len(names) > MOST_JOINTS:
        message = f"The robot has {len(names)} joints, but a coordinate system has {MOST_JOINTS} axes."
        file.say(
            "Y1318", ("joints",), message, "Fix joints in the URDF, or split the robot in two.", at_key=True
        )
    if chain is None:
        return names
    missing = [name for name in names if name not in listed]
    for name in listed:
        if name in kinds:
            continue
        remedy, subject = did_you_mean(name, missing or names)
        if subject.meant in missing:
            missing.remove(subject.meant)
        elif len(missing) == 1 and len(listed) == len(names):
            remedy, subject = f"Rename it: the joint without a table is {missing.pop()}.", Name(name)
        message = f"[joints.{name}] isn't a joint between the base and the flange of the URDF."
        file.say("Y1313", ("joints", name), message, remedy, subject, at_key=True)
    for name in missing:
        message = f"Joint {name} of the URDF has no table [joints.{name}]."
        remedy = "Add it, with position, velocity, acceleration and jerk."
        file.say("Y1312", ("joints",), message, remedy, at_key=True)
    order = [name for name in tables if name in kinds]
    in_chain = [name for name in names if name in order]
    if order != in_chain:
        at = next(name for name, right in zip(order, in_chain, strict=True) if name != right)
        message = f"The tables are in the order {', '.join(order)}, but the chain is {', '.join(in_chain)}."
        remedy = "Put them in the order of the chain: HOME, K and all other lists have that order."
        file.say("Y1314", ("joints", at), message, remedy, at_key=True)
    return names


def _check_joint(file: TomlFile, draft: RobotDraft, name: str, table: JointTable, kind: str) -> None:
    """Check the position limits of a joint, in its table [joints.NAME] of robot.toml. `kind` is the type
    that the URDF gives this joint. It is empty if the chain has no joint of this name, and "revolute" if
    the chain isn't known.
    """
    path: Path = ("joints", name, "position")
    limits = table.position
    if limits is None:
        if kind in ("revolute", "prismatic") and path not in draft.dropped:
            message = f"Joint {name} is {kind} and has no position limits."
            remedy = "Add position = [lower, upper]; only a continuous joint goes without."
            file.say("Y1315", path, message, remedy, at_key=True)
    elif len(limits) != 2:
        message = f"position of [joints.{name}] must have 2 values, but has {len(limits)}."
        file.say("Y1309", path, message, "Write position = [lower, upper].")
    elif limits[0] >= limits[1]:
        message = f"The lower limit {limits[0]:g} of joint {name} isn't below the upper limit {limits[1]:g}."
        file.say("Y1316", path, message, "Write position = [lower, upper].")


def _check_positions(
    file: TomlFile, draft: RobotDraft, names: Sequence[str], kinds: Mapping[str, str]
) -> None:
    tables = draft.table.joints or {}
    for position, values in (draft.table.positions or {}).items():
        path: Path = ("positions", position)
        if not right_length(file, path, values, len(names), "value", "joint"):
            continue
        for at, (name, value) in enumerate(zip(names, values, strict=True)):
            limits = tables[name].position if name in tables else None
            if (
                limits is None
                or len(limits) != 2
                or limits[0] >= limits[1]
                or limits[0] <= value <= limits[1]
            ):
                continue
            excess = max(limits[0] - value, value - limits[1])
            unit = "mm" if kinds.get(name) == "prismatic" else "deg"
            message = (
                f"{position} has joint {name} at {value:g} {unit}, "
                f"{excess:.6g} {unit} outside of its limits {limits[0]:g} to {limits[1]:g}."
            )
            file.say("Y1317", (*path, at), message, "Move the position, or correct the limits.")


def _check_names(file: TomlFile, draft: RobotDraft) -> None:
    """Check the names that programs and messages use: those of the robot, its frames, its tools and its
    positions.
    """
    named: list[tuple[Path, str, str]] = []
    if draft.table.name is not None:
        named.append((("name",), draft.table.name, "robot"))
    named += [(("frames", name), name, "frame") for name in draft.table.frames]
    named += [(("tools", name), name, "tool") for name in draft.table.tools]
    named += [(("positions", name), name, "position") for name in draft.table.positions or {}]
    first: dict[tuple[str, str], str] = {}
    for path, name, kind in named:
        key = (kind, name.upper())
        if not _NAME.fullmatch(name) or _INDEX.fullmatch(name):
            message = f'The {kind} has the name "{name[:40]}", which a program can\'t write.'
            remedy = "Use ASCII letters, digits and _, not a digit first, and not P with digits only."
            file.say("Y1310", path, message, remedy, at_key=kind != "robot")
        elif kind == "frame" and name.upper() in RESERVED:
            message = f"The frame {name} can't be declared: every robot has it from its chain."
            file.say("Y1310", path, message, "Give the frame another name, for example TCP.", at_key=True)
        elif key in first:
            message = (
                f"The {kind} {name} is already declared as {first[key]}: names are the same in upper "
                "and lower case."
            )
            file.say("Y1311", path, message, "Give one of the two another name.", at_key=True)
        first.setdefault(key, name)


def _check_frames(file: TomlFile, draft: RobotDraft) -> None:
    """Check the frames of robot.toml. Each frame must have the right number of values, and its chain of
    parents must end at FLANGE.
    """
    frames = draft.table.frames
    upper = {name.upper(): name for name in frames if name.upper() not in RESERVED}
    parents: dict[str, str] = {}
    for name, frame in frames.items():
        for key, values in (("xyz", frame.xyz), ("rpy", frame.rpy)):
            if len(values) != 3:
                message = f"{key} of [frames.{name}] must have 3 values, but has {len(values)}."
                file.say(
                    "Y1309", ("frames", name, key), message, f"Write {key} = [0, 0, 0] with your numbers."
                )
        parent = frame.parent.upper()
        if name.upper() in RESERVED:
            continue
        if parent in upper:
            parents[name.upper()] = parent
        elif parent != "FLANGE" and ("frames", frame.parent) not in draft.dropped:
            message = f"The parent of frame {name} is {frame.parent[:40]}, which isn't a frame on the flange."
            near = did_you_mean(parent, {"FLANGE", *upper} - {name.upper()})
            file.say("Y1329", ("frames", name, "parent"), message, *near)
    for circle in circles(parents):
        message = f"The frames {', '.join(circle)} are attached to each other in a circle."
        if len(circle) == 1:
            message = f"The frame {circle[0]} is its own parent."
        remedy = 'Give one of them parent = "FLANGE".'
        file.say("Y1330", ("frames", upper[circle[0]], "parent"), message, remedy)


def check_narrower(urdf: Urdf, draft: RobotDraft, chain: Sequence[Joint]) -> None:
    """Report position and velocity limits of robot.toml that are wider than those of the URDF. The limits of
    robot.toml are used, so the robot could exceed those of the URDF.
    """
    for joint in chain:
        table, limit = (draft.table.joints or {}).get(joint.name), joint.element.first("limit")
        if table is None or limit is None:
            continue
        unit, name = (MM, "mm") if joint.kind == "prismatic" else (DEG, "deg")
        wider: list[tuple[str, float, float, str]] = []
        # CAD exports write 0 to 0 for an unknown range, and 0 for an unknown speed
        ranged = joint.lower is None or joint.upper is None or joint.lower < joint.upper
        if table.position is not None and len(table.position) == 2 and joint.kind != "continuous" and ranged:
            for key, theirs, ours, sign in (
                ("lower", joint.lower, table.position[0], 1.0),
                ("upper", joint.upper, table.position[1], -1.0),
            ):
                if theirs is not None and sign * (theirs / unit - ours) > 1e-3:
                    wider.append((key, theirs / unit, ours, name))
        speed = joint.velocity or 0.0
        if table.velocity is not None and speed > 0.0 and table.velocity - speed / unit > 1e-3:
            wider.append(("velocity", speed / unit, table.velocity, f"{name}/s"))
        for key, theirs, ours, per in wider:
            message = f"{key} of joint {joint.name} is {theirs:.6g} {per}, but {ours:g} {per} in robot.toml."
            urdf.say(
                "Y1355", message, "The wider limit of robot.toml is used; make the two agree.", limit, key
            )
