"""Read a robot: turn its robot.toml and URDF into a `Robot`, or into findings about both files.

Heavy libraries (pydantic, Pinocchio) are imported where they are first used.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.robot.chain import check_chain, find_links, frozen, joints_between, screws
from yarclang.robot.checks import check_narrower, check_table
from yarclang.robot.contacts import allowed_pairs, check_pieces
from yarclang.robot.controller import Kind
from yarclang.robot.kinds import kind_of
from yarclang.robot.library import RobotSummary, find_robot, list_robots, stdlib_folder
from yarclang.robot.link_shapes import link_shapes
from yarclang.robot.masses import dynamics_of
from yarclang.robot.model import (
    Actuation,
    Array,
    Chain,
    Dynamics,
    JointKind,
    Limits,
    Robot,
    Tolerance,
    Tool,
    Written,
)
from yarclang.robot.urdf import MOVING, Joint, Urdf, read_urdf
from yarclang.robot.urdf_shapes import check_shapes
from yarclang.shapes import Mesh
from yarclang.source import SourceFile
from yarclang.subjects import Name
from yarclang.toml.file import TomlFile, did_you_mean
from yarclang.toml.places import find_places
from yarclang.toml.reading import parse_toml, read_text
from yarclang.units import DEG, MM, MS

if TYPE_CHECKING:
    from yarclang.robot.draft import RobotDraft
    from yarclang.robot.schema import RobotTable

__all__ = ["RobotSummary", "list_robots", "load_robot", "read_robot", "stdlib_folder"]

T = TypeVar("T")


def load_robot(name_or_path: str) -> Result[Robot]:
    """Read a robot. A robot of the standard library is cached until one of its files changes.

    Args:
        name_or_path: the name of a robot of the standard library in any case (INDUSTRIAL6), or the path of a
            robot.toml or of a folder that contains one.

    Returns:
        The robot, with any warnings. If robot.toml or the URDF has mistakes, None with all of these mistakes.
    """
    path, near = find_robot(name_or_path)
    if path is None:
        names = ", ".join(robot.name for robot in list_robots())
        folder = name_or_path.lower()
        here = os.path.basename(folder) == folder  # noqa: PTH119 (no name is refused)
        if not near and here and os.path.isfile(f"{folder}/robot.toml"):  # noqa: PTH113 (never raises)
            near = f"./{folder}"
        remedy = f"The robots are {names}; give your own robot by its path."
        remedy = f"Did you mean {near}? {remedy}" if near else remedy
        message, subject = f"There is no robot {name_or_path[:80]!r}.", Name(name_or_path, near)
        return _nothing(Diagnostic("Y1301", message, help=remedy, subject=subject))
    if path.parent.parent == stdlib_folder() / "robots":
        return _of_library(path, _stamp(path.parent))
    return _read(path)


@lru_cache(maxsize=16)
def _of_library(path: Path, _: Hashable) -> Result[Robot]:
    """Read a robot of the standard library, or return it from the cache. The second argument is only part of
    the cache's key; it changes when the robot's files change.
    """
    return _read(path)


def _stamp(folder: Path) -> Hashable:
    """Return a value that changes when a file of a robot's folder changes."""
    try:
        files = [(one, one.stat()) for one in sorted(folder.iterdir())]
    except OSError:
        return object()
    return tuple((str(one), seen.st_mtime_ns, seen.st_size, seen.st_ino) for one, seen in files)


def _read(path: Path) -> Result[Robot]:
    """Read the robot of a robot.toml."""
    source = read_text(path, "Name a folder with a robot.toml, or a robot of the library.")
    if isinstance(source, Diagnostic):
        return _nothing(source)
    return read_robot(source, path.parent)


def read_robot(source: SourceFile, folder: Path) -> Result[Robot]:
    """Read a robot from the text of a robot.toml, for example while the text is edited.

    Args:
        source: the text.
        folder: the folder in which the file belongs.

    Returns:
        The same as `load_robot`.
    """
    data = parse_toml(source)
    if isinstance(data, Diagnostic):
        return _nothing(data)
    return _load(folder.absolute(), source, data)


def _load(folder: Path, source: SourceFile, data: dict[str, Any]) -> Result[Robot]:
    """Read the robot of a robot.toml that is valid TOML."""
    from yarclang.robot.draft import read_draft
    from yarclang.robot.tools import check_tools, flange_frames, tools_of

    file = TomlFile(source, find_places(source))
    draft = read_draft(data)
    draft.tell(file)
    urdf, shapes = _open_urdf(file, folder, draft)
    moving: tuple[Joint, ...] | None = None
    if urdf is not None and urdf.sound:
        ends = {
            key: link for key, link in (("base", draft.table.base), ("flange", draft.table.flange)) if link
        }
        lost = find_links(urdf, ends)
        for key, message, remedy, subject in lost:
            file.say("Y1347", (key,), message, remedy, subject)
        if len(ends) == 2 and not lost:
            moving = _chain(file, urdf, (ends["base"], ends["flange"]), draft.table.ignored_joints)
    check_table(file, draft, moving)
    check_tools(file, draft, folder)
    if urdf is not None and moving is not None:
        check_narrower(urdf, draft, moving)
    findings = [*file.findings, *(urdf.findings if urdf else ())]
    if urdf is None or moving is None or has_errors(findings):
        return Result(None, in_order(findings))
    table = draft.table
    chain = screws(urdf, _required(table.base), _required(table.flange), moving)
    if chain is None:
        return Result(None, in_order([*findings, *urdf.findings]))
    allowed = allowed_pairs(file, folder, table, urdf)
    check_pieces(file, table, urdf)
    if has_errors(file.findings):
        return Result(None, in_order([*file.findings, *urdf.findings]))
    bodies = link_shapes(
        urdf, (folder / _required(table.urdf)).parent, _required(table.base), moving, table.collision.pieces
    )
    frames = flange_frames(table)
    tools = tools_of(file, table, frames, folder)
    efforts = [_required(table.joints)[joint.name].effort for joint in moving]
    said = (efforts, table.dynamics.gravity, table.dynamics.checked)
    dynamics = dynamics_of(urdf, (_required(table.base), moving), chain, tools, said)
    robot = _assemble(folder, table, moving, chain, frames)
    fingerprint = _fingerprint(table, urdf, shapes, allowed, (tools, dynamics))
    written = Written(source.text, urdf.text)
    robot = replace(robot, shapes=bodies, allowed=allowed, tools=tools, dynamics=dynamics, written=written)
    if (name := Path(source.name).name).endswith(".toml"):  # a text that is edited may have no file
        robot = replace(robot, file_name=name)
    return Result(replace(robot, fingerprint=fingerprint), in_order(findings))


def _open_urdf(file: TomlFile, folder: Path, draft: RobotDraft) -> tuple[Urdf | None, dict[str, list[str]]]:
    """Return the URDF with its findings, and the collision shapes of its links."""
    name = draft.table.urdf
    if name is None:
        return None, {}
    source = read_text(folder / name, "")
    if isinstance(source, Diagnostic) and source.source is not None:
        file.findings.append(source)
        return None, {}
    if isinstance(source, Diagnostic):
        file.say(
            "Y1302",
            ("urdf",),
            source.message,
            "Give the URDF file's path relative to the folder of this robot.toml.",
        )
        return None, {}
    urdf = read_urdf(source)
    return urdf, check_shapes(urdf, folder / Path(name).parent)


def _chain(
    file: TomlFile,
    urdf: Urdf,
    ends: tuple[str, str],
    ignored: Sequence[str],
) -> tuple[Joint, ...] | None:
    """Return the moving joints from the base to the flange. If there is no such chain, report it and return
    None.
    """
    base, flange = ends
    joints = joints_between(urdf, base, flange)
    if joints is None:
        back = joints_between(urdf, flange, base) is not None
        message = f"No chain of joints leads from the base {base} to the flange {flange}"
        message += ", only from the flange to the base." if back else "."
        remedy = "Swap base and flange." if back else "Name a link above the flange as base, the arm's foot."
        file.say("Y1353", ("base",), message, remedy)
        return None
    moving = tuple(joint for joint in joints if joint.kind in MOVING)
    if not moving:
        message = f"No joint between the base {base} and the flange {flange} moves."
        file.say("Y1353", ("base",), message, "Name the arm's foot as base and its end as flange.")
        return None
    for at, name in enumerate(ignored):
        if name in urdf.joints and name not in (joint.name for joint in joints):
            continue
        place = "is between the base and the flange" if name in urdf.joints else "the URDF doesn't have"
        message = f"ignored_joints has {name[:40]}, which {place}."
        strays = [
            joint.name for joint in urdf.joints.values() if joint.kind != "fixed" and joint not in joints
        ]
        file.say("Y1362", ("ignored_joints", at), message, *did_you_mean(name, strays))
    sound = check_chain(urdf, joints, ignored)
    return moving if sound else None


def _assemble(
    folder: Path,
    table: RobotTable,
    joints: Sequence[Joint],
    chain: Chain,
    frames: Mapping[str, Array],
) -> Robot:
    """Build the robot from the tables of a robot.toml in which no mistakes were found. All quantities are in
    SI units; the collision shapes are added later.
    """
    actuation, motors, controller = (
        _required(table.actuation),
        _required(table.motors),
        _required(table.controller),
    )
    units = np.where(chain.is_prismatic, MM, DEG)
    size = len(joints)
    return Robot(
        name=_required(table.name).upper(),
        title=table.title,
        folder=folder,
        urdf=_required(table.urdf),
        joint_names=tuple(joint.name for joint in joints),
        joint_kinds=tuple(_kind(joint.kind) for joint in joints),
        chain=chain,
        limits=_limits(table, joints, units),
        flange_from_frame=MappingProxyType(dict(frames)),
        positions=MappingProxyType(
            {
                name.upper(): frozen(np.array(values) * units)
                for name, values in _required(table.positions).items()
            }
        ),
        actuation=Actuation(
            gear=frozen(_required(actuation.K)),
            coupling=frozen(_required(actuation.J)),
            offset=frozen(actuation.a0 if actuation.a0 is not None else np.zeros(size)),
            velocity=frozen(np.array(_required(motors.velocity)) / MS),
        ),
        controller=_kind_of(controller.kind).controller(controller, _required(motors.numbers)),
        tolerance=Tolerance(table.tolerance.position * MM, table.tolerance.angle * DEG),
        fingerprint="",
        jog_speed=table.jog.speed * MM,
    )


def _limits(table: RobotTable, joints: Sequence[Joint], units: Array) -> Limits:
    rows = [_required(table.joints)[joint.name] for joint in joints]
    ends = [row.position if row.position is not None else [-np.inf, np.inf] for row in rows]
    acceleration = [_required(row.acceleration) for row in rows]
    stops = [row.stop_acceleration or own for row, own in zip(rows, acceleration, strict=True)]
    return Limits(
        lower=frozen(np.array([low for low, _ in ends]) * units),
        upper=frozen(np.array([high for _, high in ends]) * units),
        velocity=frozen(np.array([_required(row.velocity) for row in rows]) * units),
        acceleration=frozen(np.array(acceleration) * units),
        jerk=frozen(np.array([_required(row.jerk) for row in rows]) * units),
        stop_acceleration=frozen(np.array(stops) * units),
    )


def _fingerprint(
    table: RobotTable,
    urdf: Urdf,
    shapes: Mapping[str, Sequence[str]],
    allowed: frozenset[tuple[str, str]],
    more: tuple[tuple[Tool, ...], Dynamics],
) -> str:
    """Return the SHA-256 of everything in the robot's files that affects compiled programs.

    It depends on values, joints, collision shapes (meshes by their bytes), and tools. It depends on masses
    only if torques are checked. Comments, layout, visual shapes, and whether a number has a decimal point
    make no difference.
    """
    joints = {
        joint.name: [joint.kind, joint.parent, joint.child, joint.xyz, joint.rpy, joint.axis]
        for joint in urdf.joints.values()
    }
    tools, dynamics = more
    # leave out the tables that are added below if the robot uses them: a table that the robot doesn't use
    # must not change its fingerprint. The table [ramps] is left out because the values of `joints` contain
    # the accelerations and jerks that [ramps] determines
    later = {"tools", "bodies", "dynamics", "ramps"}
    values = table.model_dump(exclude={"urdf", "ignored_joints", "collision", "jog", *later})
    for joint in values["joints"].values():
        joint.pop("effort")
    parts: list[object] = [values, joints, dict(shapes), *sorted(allowed)]
    if tools:
        meshes = [one.shape.digest for tool in tools for one in tool.shapes if isinstance(one.shape, Mesh)]
        said = table.model_dump(include={"tools", "bodies"})
        for body in said["bodies"]:
            if body["pieces"] is None:
                del body["pieces"]
        parts += [said, meshes]
    if table.collision.pieces:
        parts.append({"pieces": table.collision.pieces})
    if dynamics.is_checked:
        parts += [getattr(dynamics, name).tolist() for name in _OF_DYNAMICS]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


_OF_DYNAMICS = ("mass", "center", "inertia", "gravity", "effort")


def _nothing(finding: Diagnostic) -> Result[Robot]:
    return Result(None, (finding,))


def _kind(kind: str) -> JointKind:
    if kind == "revolute":
        return "revolute"
    return "prismatic" if kind == "prismatic" else "continuous"


def _kind_of(kind: str) -> Kind:
    """Return the kind of controller that a robot.toml names; the robot.toml must have no mistakes."""
    return _required(kind_of(kind))


def _required(value: T | None) -> T:
    """Return a required value of a robot.toml; the robot.toml must have no mistakes."""
    if value is None:
        raise AssertionError("a required key passed the checks without a value")
    return value
