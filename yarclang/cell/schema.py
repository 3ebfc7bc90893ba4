"""The schema of a cell.toml as pydantic models: its tables, keys and types, in the units that the file names.

This module imports pydantic; import it late.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from yarclang.meshes.pieces import MOST_PIECES
from yarclang.toml.tables import LARGEST, Document, Number, Positive, Table

Margin = Annotated[float, Field(ge=0.0, le=LARGEST)]

MOST_PARTS = 10_000
"""The largest number of parts of one kind."""


class Placed(Table):
    """The pose of an entry in a frame: x y z, and roll pitch yaw or a quaternion x y z w."""

    xyz: list[Number] | None = None
    rpy: list[Number] | None = None
    quat: list[Number] | None = None
    units: str | None = None


class FrameTable(Placed):
    """`[frames.NAME]`."""

    required = ("parent",)
    parent: str | None = None


class JointsTable(Table):
    """`[joints]` NAME = [...], or `[joints.NAME]` with values and units."""

    required = ("values",)
    values: list[Number] | None = None
    units: str | None = None


class InputTable(Table):
    """`[inputs]` NAME = "M11", or `[inputs.NAME]` with a variable."""

    required = ("variable",)
    variable: str | None = None


class OutputTable(Table):
    """`[outputs]` NAME = "M1", or `[outputs.NAME]` with a variable, a safe value, and the gripper that it
    moves.
    """

    required = ("variable",)
    wanted: ClassVar = dict.fromkeys(
        ("safe", "grips_at", "removes_at", "locks_at"), '"ON", "OFF" or a number'
    )
    variable: str | None = None
    safe: Number | None = None
    grips: str | None = None
    grips_at: Number | None = None
    removes: str | None = None
    removes_at: Number | None = None
    locks_at: Number | None = None
    tool: str | None = None
    reach: Margin | None = None


class BodyTable(Placed):
    """The keys that obstacles and parts have in common. Which of the keys for sizes are needed depends on the
    shape.
    """

    required = ("name", "shape", "frame")
    name: str | None = None
    shape: Literal["box", "sphere", "cylinder", "capsule", "mesh"] | None = None
    frame: str | None = None
    size: list[Positive] | None = None
    radius: Positive | None = None
    length: Positive | None = None
    file: str | None = None
    pieces: Annotated[int, Field(ge=1, le=MOST_PIECES)] | None = None
    margin: Margin = 0.0


class ObstacleTable(BodyTable):
    """`[[obstacles]]`."""


class PartTable(BodyTable):
    """`[[parts]]`; the mass of a part is in kg."""

    mass: Positive | None = None
    count: Annotated[int, Field(ge=1, le=MOST_PARTS)] = 1


class RackTable(Placed):
    """`[[tools]]`: a changeable tool of robot.toml. Its place is the pose of the flange at which the robot
    takes the tool and puts it back.
    """

    required = ("name", "frame")
    name: str | None = None
    frame: str | None = None
    on: bool = False
    frames: list[str] | None = None
    margin: Margin = 0.0


class SensorTable(Placed):
    """`[[sensors]]`; the keys depend on the kind."""

    required = ("input", "kind")
    input: str | None = None
    kind: Literal["beam", "proximity", "vacuum"] | None = None
    frame: str | None = None
    to: list[Number] | None = None
    range: Positive | None = None
    gripper: str | None = None
    inverted: bool = False


class ZoneTable(Placed):
    """`[[zones]]`; the keys depend on the shape and the rule."""

    required = ("name", "rule", "shape")
    name: str | None = None
    rule: Literal["allowed", "forbidden", "slow", "posture"] | None = None
    shape: Literal["box", "sphere", "cylinder", "capsule", "half-space", "joints"] | None = None
    frame: str | None = None
    size: list[Positive] | None = None
    radius: Positive | None = None
    length: Positive | None = None
    normal: list[Number] | None = None
    joints: dict[str, list[Number]] | None = None
    speed: Positive | None = None
    watch: list[str] | None = None
    margin: Margin | None = None


class StartTable(Table):
    """`[[starts]]`: a range of joint positions from which the robot may move to the start of a program
    without an order of the user.
    """

    required = ("name", "joints")
    name: str | None = None
    joints: dict[str, list[Number]] | None = None
    units: str | None = None


class AllowTable(Table):
    """`[[allow]]`: two bodies that may touch during motions that lead to a frame, or that leave it."""

    required = ("bodies",)
    wanted: ClassVar = {"bodies": 'the names of two bodies, such as ["GRIPPER", "BOX"]'}
    bodies: list[str] | None = None
    leads_to: str | None = None
    leaves: str | None = None


class KeepTable(Table):
    """`[[keep]]`: a rule that all motions must satisfy; the keys depend on the rule."""

    required = ("frame", "rule")
    frame: str | None = None
    rule: Literal["upright", "above", "facing", "seen"] | None = None
    of: str | None = None
    angle: Positive | None = None
    distance: Number | None = None
    range: list[Number] | None = None
    units: str | None = None


class CellTable(Document):
    """The whole file."""

    units: str | None = None
    frames: dict[str, FrameTable] = Field(default={})
    joints: dict[str, JointsTable] = Field(default={})
    inputs: dict[str, InputTable] = Field(default={})
    outputs: dict[str, OutputTable] = Field(default={})
    obstacles: list[ObstacleTable] = Field(default=[])
    zones: list[ZoneTable] = Field(default=[])
    parts: list[PartTable] = Field(default=[])
    tools: list[RackTable] = Field(default=[])
    sensors: list[SensorTable] = Field(default=[])
    starts: list[StartTable] = Field(default=[])
    allow: list[AllowTable] = Field(default=[])
    keep: list[KeepTable] = Field(default=[])
    wanted: ClassVar = {
        "allow": "tables, each under [[allow]]",
        "keep": "tables, each under [[keep]]",
        "obstacles": "tables, each under [[obstacles]]",
        "parts": "tables, each under [[parts]]",
        "sensors": "tables, each under [[sensors]]",
        "starts": "tables, each under [[starts]]",
        "tools": "tables, each under [[tools]]",
        "zones": "tables, each under [[zones]]",
        "units": 'a text such as "mm,deg"',
    }
    tables: ClassVar = {
        "frames": FrameTable,
        "joints": JointsTable,
        "inputs": InputTable,
        "outputs": OutputTable,
        "obstacles": ObstacleTable,
        "zones": ZoneTable,
        "keep": KeepTable,
        "parts": PartTable,
        "tools": RackTable,
        "sensors": SensorTable,
        "starts": StartTable,
        "allow": AllowTable,
    }
    examples: ClassVar = {
        "parent": ('parent = "B" for a fixed frame, "FLANGE" for a tool, or the name of another frame.'),
        "values": "values = [...], one for each joint.",
        "variable": 'for example variable = "M11".',
        "name": 'for example name = "TABLE", which findings show.',
        "shape": 'for example shape = "box".',
        "frame": 'frame = "B", or the name of the frame for x y z.',
        "rule": 'rule = "allowed", "forbidden", "slow" or "posture".',
        "size": "size = [x, y, z], the full lengths of the edges.",
        "radius": "for example radius = 40.",
        "length": "for example length = 200, along z.",
        "file": 'for example file = "press.stl", a path from the folder of this file.',
        "normal": "normal = [0, 0, 1], the direction into the half-space.",
        "joints": "joints = { J1 = [-90, 90] }, the smallest and largest value of each limited joint.",
        "speed": "for example speed = 250, in the file's units of length and time.",
        "input": 'for example input = "PART_READY", a name of [inputs].',
        "kind": 'kind = "beam", "proximity" or "vacuum".',
        "to": "to = [x, y, z], where the beam ends.",
        "range": "for example range = 30, the distance around x y z.",
        "bodies": 'bodies = ["GRIPPER", "BOX"], the names of the two bodies that may touch.',
        "gripper": 'for example gripper = "GRIP", an output with grips.',
    }


def spelled_out(data: dict[str, Any]) -> dict[str, Any]:
    """Expand the short forms in the data of a cell.toml (READY = [...], DOOR = "M11", safe = "OFF"), and
    return the result.
    """
    made = dict(data)
    for key, inner in (("joints", "values"), ("inputs", "variable"), ("outputs", "variable")):
        table = made.get(key)
        if isinstance(table, dict):
            made[key] = {
                name: dict(entry) if isinstance(entry, dict) else {inner: entry}
                for name, entry in table.items()
            }
    outputs = made.get("outputs")
    for entry in outputs.values() if isinstance(outputs, dict) else ():
        for key in ("safe", "grips_at", "removes_at", "locks_at"):
            state = entry.get(key)
            if isinstance(state, str) and state.upper() in _STATES:
                entry[key] = _STATES[state.upper()]
    return made


_STATES = {"ON": 1.0, "OFF": 0.0}
