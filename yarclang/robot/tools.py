"""Read the tools of a robot.toml: their shapes, masses, and poses on the flange."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from yarclang.robot.chain import frozen
from yarclang.robot.model import Array, Tool, ToolShape
from yarclang.shapes import Shape
from yarclang.toml.bodies import OF_MESHES, OF_SHAPES, SIZES, Keys, has_its_keys, named_mesh, simple_shape
from yarclang.toml.draft import table_name
from yarclang.toml.file import TomlFile, did_you_mean
from yarclang.toml.places import Path
from yarclang.transforms import constant, rpy_rotation
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.robot.draft import RobotDraft
    from yarclang.robot.schema import BodyTable, RobotTable, ToolTable

SLACK = 1e-6
"""By how much the principal moments of an inertia may violate the conditions for a rigid body, relative to
the inertia. The components in files are rounded to few digits, so that they violate the conditions slightly.
"""


def check_tools(file: TomlFile, draft: RobotDraft, folder: FilePath) -> None:
    """Report all findings about tools and their shapes, and about gravity.

    Args:
        file: the robot.toml, which collects the findings.
        draft: its tables.
        folder: the folder of the file; mesh files are relative to it.
    """
    _sized(file, ("dynamics", "gravity"), draft.table.dynamics.gravity, 3)
    frames = {"FLANGE", *(name.upper() for name in draft.table.frames)}
    lost = {str(path[1]).upper() for path in draft.dropped if path[0] == "frames" and len(path) > 1}
    for name, tool in draft.table.tools.items():
        weighed = not any(path[:2] == ("tools", name) for path in draft.dropped)
        _check_tool(file, ("tools", name), tool, (frames, lost), weighed=weighed)
    broken = {str(path[1]).upper() for path in draft.dropped if path[0] == "tools" and len(path) > 1}
    names = {name.upper() for name in draft.table.tools} | broken
    for at, body in enumerate(draft.table.bodies):
        path: Path = ("bodies", at)
        if body.tool is not None and body.tool.upper() not in names:
            message = f"{table_name(path)} belongs to the tool {body.tool[:40]}, which the file doesn't have."
            remedy, subject = did_you_mean(body.tool.upper(), names)
            file.say("Y0931", (*path, "tool"), message, f"{remedy} A tool is a table [tools.NAME].", subject)
        if body.shape is not None:
            keys = Keys(f"a {body.shape}", SIZES[body.shape], OF_MESHES if body.shape == "mesh" else ())
            every = (*OF_SHAPES, *OF_MESHES)
            if has_its_keys(body, (file, type(draft.table), path), keys, every, draft.dropped):
                for key, size in (("size", 3), ("xyz", 3), ("rpy", 3)):
                    _sized(file, (*path, key), getattr(body, key), size)
                if body.shape == "mesh":
                    named_mesh(str(body.file), MM, (file, (*path, "file")), folder)


def flange_frames(table: RobotTable) -> dict[str, Array]:
    """Return the pose flange_from_frame of each frame of the robot.toml and of FLANGE, by the frame's name in
    upper case.
    """
    frames = {name.upper(): frame for name, frame in table.frames.items()}
    placed: dict[str, Array] = {"FLANGE": np.eye(4)}
    while len(placed) <= len(frames):  # parents come first; `check_table` has excluded circles of parents
        for name, frame in frames.items():
            if name not in placed and frame.parent.upper() in placed:
                placed[name] = placed[frame.parent.upper()] @ _transform(frame.xyz, frame.rpy)
    return {name: frozen(pose) for name, pose in placed.items()}


def _transform(xyz: Sequence[float], rpy: Sequence[float]) -> Array:
    """Return the pose parent_from_frame (4, 4) of a frame, from its position [mm] and R = Rz(yaw) Ry(pitch)
    Rx(roll) [deg].
    """
    pose = np.eye(4)
    pose[:3, :3] = rpy_rotation(np.array(rpy) * DEG)
    pose[:3, 3] = np.array(xyz) * MM
    return pose


def tools_of(
    file: TomlFile, table: RobotTable, flange_from_frame: Mapping[str, Array], folder: FilePath
) -> tuple[Tool, ...]:
    """Return the tools of a correct robot.toml, in the order of the file.

    Args:
        file: the robot.toml, which collects findings about mesh files.
        table: its tables.
        flange_from_frame: the frames on the flange, by name in upper case.
        folder: the folder of the file; mesh files are relative to it.
    """
    shapes: dict[str, list[ToolShape]] = {name.upper(): [] for name in table.tools}
    frames = {name.upper(): flange_from_frame[tool.frame.upper()] for name, tool in table.tools.items()}
    for at, body in enumerate(table.bodies):
        name = str(body.tool).upper()
        made = _shape(file, body, ("bodies", at), folder)
        shapes[name].append(ToolShape(constant(frames[name] @ _transform(body.xyz, body.rpy)), made))
    tools = []
    for name, tool in table.tools.items():
        frame = frames[name.upper()]
        turn = frame[:3, :3]
        center = turn @ (np.array(tool.center_of_mass or [0.0] * 3) * MM) + frame[:3, 3]
        inertia = turn @ _tensor(tool.inertia or [0.0] * 6) @ turn.T
        own = tuple(shapes[name.upper()])
        mass = tool.mass or 0.0
        tools.append(
            Tool(
                name.upper(), tool.mounted, mass, constant(center), constant(inertia), own, tool.frame.upper()
            )
        )
    return tuple(tools)


def _check_tool(
    file: TomlFile, path: Path, tool: ToolTable, names: tuple[set[str], set[str]], *, weighed: bool
) -> None:
    """Check one tool.

    Args:
        file: the robot.toml, which collects the findings.
        path: the keys that lead to the tool's table.
        tool: its values.
        names: the frames of the file, and the frames that couldn't be read.
        weighed: False if a missing mass was already reported.
    """
    frames, lost = names
    if tool.frame.upper() not in frames | lost:
        message = f"The frame of tool {path[1]} is {tool.frame[:40]}, which isn't a frame on the flange."
        file.say("Y1329", (*path, "frame"), message, *did_you_mean(tool.frame.upper(), frames))
    whole = True
    for key, size in (("center_of_mass", 3), ("inertia", 6)):
        values = getattr(tool, key)
        whole &= _sized(file, (*path, key), values, size)
        if values is not None and not tool.mass and weighed:
            message = f"{table_name(path)} has {key}, but no mass."
            file.say("Y1304", (*path, key), message, "Add mass = ..., in kg.", at_key=True)
    if tool.inertia is None or not whole:
        return
    # principal moments of a rigid body are not negative, and each is at most the sum of the others
    least, middle, most = np.linalg.eigvalsh(_tensor(tool.inertia))
    if least < -SLACK * abs(most) or most > (least + middle) * (1.0 + SLACK):
        shown = ", ".join(f"{value:.4g}" for value in (least, middle, most))
        message = (
            f"inertia of {table_name(path)} has the principal moments {shown} kg m^2, which are impossible "
            "for a body."
        )
        remedy = (
            "Give it about the centre of mass as xx, yy, zz, xy, xz, yz in kg m^2; each principal moment "
            "is at most the sum of the others."
        )
        file.say("Y0932", (*path, "inertia"), message, remedy)


def _sized(file: TomlFile, path: Path, values: Sequence[float] | None, size: int) -> bool:
    if values is None or len(values) == size:
        return True
    message = f"{path[-1]} of {table_name(path[:-1])} must have {size} values, but has {len(values)}."
    what = "xx, yy, zz, xy, xz, yz" if size == 6 else "x, y, z"
    what = "roll, pitch, yaw" if path[-1] == "rpy" else what
    file.say("Y1309", path, message, f"Write {path[-1]} = [{what}] with your numbers.")
    return False


def _shape(file: TomlFile, body: BodyTable, path: Path, folder: FilePath) -> Shape:
    if body.shape == "mesh":
        made = named_mesh(str(body.file), MM, (file, (*path, "file")), folder, body.pieces or 0)
        assert made is not None  # the check of the file's form has found this mesh
        return made
    return simple_shape(str(body.shape), body, MM)


def _tensor(values: Sequence[float]) -> Array:
    xx, yy, zz, xy, xz, yz = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
