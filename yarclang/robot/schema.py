"""Define the form of a robot.toml: its tables, keys and types, in the units of the file (deg, mm, counts,
ms).

This module imports pydantic; import it late.
"""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, create_model

from yarclang.meshes.pieces import MOST_PIECES
from yarclang.robot.kinds import DEFAULT, kind_names, kind_of
from yarclang.toml.tables import LARGEST, LEAST, Document, Number, Positive, Table

Pieces = Annotated[int, Field(ge=1, le=MOST_PIECES)]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST)]


class JointTable(Table):
    """`[joints.NAME]`: positions in deg; velocities, accelerations and jerks in deg per s, s^2, s^3; efforts
    in N m. For a prismatic joint, mm and N replace deg and N m.
    """

    required = ("velocity", "acceleration", "jerk")
    position: list[Number] | None = None
    velocity: Positive | None = None
    acceleration: Positive | None = None
    jerk: Positive | None = None
    stop_acceleration: Positive | None = None
    effort: Positive | None = None


Ramp = Annotated[float, Field(ge=1.0, le=60_000.0)]


class RampsTable(Table):
    """`[ramps]`: times [ms] in which joints reach their velocity limit (`rise`) and their acceleration limit
    (`ease`). They apply to joints whose own tables set no acceleration or no jerk.
    """

    rise: Ramp | None = None
    ease: Ramp | None = None


class FrameTable(Table):
    """`[frames.NAME]`: pose of a frame relative to its parent frame, in mm and deg (roll, pitch, yaw)."""

    parent: str = "FLANGE"
    xyz: list[Number] = Field(default=[0.0, 0.0, 0.0])
    rpy: list[Number] = Field(default=[0.0, 0.0, 0.0])


class ActuationTable(Table):
    """`[actuation]`: counts = K J q + a0, with q in deg or mm."""

    required = ("K", "J")
    K: list[Number] | None = None
    J: list[list[Number]] | None = None
    a0: list[Number] | None = None


class MotorsTable(Table):
    """`[motors]`: the controller's numbers, and the largest speeds [counts/ms]."""

    required = ("numbers", "velocity")
    numbers: list[Annotated[int, Field(ge=1, le=32)]] | None = None
    velocity: list[Positive] | None = None


class ControllerTable(Table):
    """`[controller]`: the keys for all kinds of controllers, with times in ms. Each kind extends this table
    (`Kind.table`).
    """

    required: ClassVar[tuple[str, ...]] = ("axes",)
    kind: str = DEFAULT
    axes: list[str] | None = None
    largest_tm: Number = 50.0
    hold_time: Annotated[float, Field(ge=1.0, le=8_388_607.0)] = 250.0
    rapid_share: Annotated[float, Field(ge=0.001, le=1.0)] = 0.1


class ToleranceTable(Table):
    """`[tolerance]`: largest distance of the executed path from the programmed one, in mm and deg."""

    position: Annotated[float, Field(ge=LEAST, le=1e6)] = 0.02
    angle: Annotated[float, Field(ge=LEAST, le=180.0)] = 0.002


class JogTable(Table):
    """`[jog]`: the largest speed of the tool's origin in live motions, mm/s."""

    speed: Annotated[float, Field(ge=0.1, le=5000.0)] = 250.0


class CollisionTable(Table):
    """`[collision]`: pairs of links that may touch each other, an SRDF that lists more pairs, and the links
    whose meshes are divided into convex pieces, each with the largest number of pieces.
    """

    allowed: list[list[str]] = Field(default=[])
    srdf: str | None = None
    pieces: dict[str, Pieces] = Field(default={})


class ToolTable(Table):
    """`[tools.NAME]`: a tool on the flange, described relative to `frame`: mass in kg, centre of mass in mm,
    and inertia in kg m^2 (xx, yy, zz, xy, xz, yz about the centre of mass).
    """

    frame: str = "FLANGE"
    mounted: bool = True
    mass: NotNegative | None = None
    center_of_mass: list[Number] | None = None
    inertia: list[Number] | None = None


class BodyTable(Table):
    """`[[bodies]]`: a shape of a tool, in mm and deg, relative to the tool's frame."""

    required = ("tool", "shape")
    tool: str | None = None
    shape: Literal["box", "sphere", "cylinder", "capsule", "mesh"] | None = None
    xyz: list[Number] = Field(default=[0.0, 0.0, 0.0])
    rpy: list[Number] = Field(default=[0.0, 0.0, 0.0])
    size: list[Positive] | None = None
    radius: Positive | None = None
    length: Positive | None = None
    file: str | None = None
    pieces: Pieces | None = None


class DynamicsTable(Table):
    """`[dynamics]`: gravity in m/s^2, in the axes of {B}; `checked` is True to compare torques with effort
    limits.
    """

    checked: bool = True
    gravity: list[Number] | None = None


class RobotTable(Document):
    """The whole robot.toml."""

    required = (
        "name",
        "urdf",
        "base",
        "flange",
        "joints",
        "positions",
        "actuation",
        "motors",
        "controller",
    )
    name: str | None = None
    title: str = ""
    urdf: str | None = None
    base: str | None = None
    flange: str | None = None
    ignored_joints: list[str] = Field(default=[])
    joints: dict[str, JointTable] | None = None
    ramps: RampsTable | None = None
    frames: dict[str, FrameTable] = Field(default={})
    positions: dict[str, list[Number]] | None = None
    actuation: ActuationTable | None = None
    motors: MotorsTable | None = None
    controller: ControllerTable | None = None
    tolerance: ToleranceTable = Field(default_factory=ToleranceTable)
    jog: JogTable = Field(default_factory=JogTable)
    collision: CollisionTable = Field(default_factory=CollisionTable)
    tools: dict[str, ToolTable] = Field(default={})
    bodies: list[BodyTable] = Field(default=[])
    dynamics: DynamicsTable = Field(default_factory=DynamicsTable)
    wanted: ClassVar = {"bodies": "tables, each under [[bodies]]"}
    tables: ClassVar = {
        "joints": JointTable,
        "ramps": RampsTable,
        "frames": FrameTable,
        "actuation": ActuationTable,
        "motors": MotorsTable,
        "controller": ControllerTable,
        "tolerance": ToleranceTable,
        "jog": JogTable,
        "collision": CollisionTable,
        "tools": ToolTable,
        "bodies": BodyTable,
        "dynamics": DynamicsTable,
    }
    examples: ClassVar = {
        "name": 'for example name = "INDUSTRIAL6".',
        "urdf": 'for example urdf = "industrial6.urdf", a file beside the robot.toml.',
        "base": 'for example base = "base_link", the link of the URDF that is {B}.',
        "flange": 'for example flange = "flange", the link of the URDF that is {FLANGE}.',
        "joints": "it has one table [joints.NAME] for each joint of the URDF.",
        "positions": "it needs HOME = [...], one value per joint.",
        "actuation": "it needs K = [...] and J = [[...], ...], as in counts = K J q + a0.",
        "motors": "it needs numbers = [...] and velocity = [...] in counts/ms.",
        "controller": 'it needs axes = ["X", ...] and feedback = ["P1", ...].',
        "velocity": "for example velocity = 60, in deg/s or mm/s (counts/ms in [motors], a list).",
        "acceleration": "for example acceleration = 240, in deg/s^2 or mm/s^2; or [ramps] with rise, in ms, for all "  # noqa: E501
        "joints.",
        "jerk": "for example jerk = 2000, in deg/s^3 or mm/s^3; or [ramps] with ease, in ms, for all joints.",
        "HOME": "HOME = [...], one value per joint in deg or mm.",
        "tool": 'for example tool = "GRIPPER", the NAME of a table [tools.NAME].',
        "shape": 'for example shape = "box".',
        "size": "size = [x, y, z], the full edge lengths in mm.",
        "radius": "for example radius = 40, in mm.",
        "length": "for example length = 200, in mm, along z.",
        "file": 'for example file = "gripper.stl", in mm, relative to the folder of this file.',
        "mass": "for example mass = 1.8, in kg.",
        "J": (
            "J = [[...], ...], one row per motor and one column per joint; without coupling the "
            "identity matrix."
        ),
    }


@cache
def robot_table(kind: str) -> type[RobotTable]:
    """Return the schema of a robot.toml for a kind of controller; for an unknown kind, a schema that rejects
    the kind.
    """
    found = kind_of(kind) or kind_of(DEFAULT)
    assert found is not None
    controller = found.table()
    if found.name != kind:
        allowed: Any = Literal[kind_names()]
        controller = create_model("AnyController", __base__=controller, kind=(allowed, DEFAULT))
    optional: Any = controller | None
    made: type[RobotTable] = create_model("RobotTable", __base__=RobotTable, controller=(optional, None))
    made.tables = {**RobotTable.tables, "controller": controller}
    return made
