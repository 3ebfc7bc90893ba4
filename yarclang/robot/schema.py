"""The form of a robot.toml: its tables, keys and types, in the units of the file (deg, mm, counts, ms).

A required key is optional to pydantic and stands in `required`: so that a file with one bad value
can still be checked in all that doesn't depend on it. This module imports pydantic; import it late.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field

LARGEST = 1e12
"""No number of a robot is larger, whatever its unit: beyond it, sums and products lose their digits."""
LEAST = 1e-6
"""The least speed, acceleration, jerk, tolerance."""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Field(ge=LEAST, le=LARGEST)]


class Table(BaseModel):
    """A table of the file: strict types, no other keys.

    Validators are built when first used: only that of the whole file is.
    """

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)
    required: ClassVar[tuple[str, ...]] = ()


class JointTable(Table):
    """`[joints.NAME]`: deg (mm for a prismatic joint), per s, s^2, s^3."""

    required = ("velocity", "acceleration", "jerk")
    position: list[Number] | None = None
    velocity: Positive | None = None
    acceleration: Positive | None = None
    jerk: Positive | None = None
    stop_acceleration: Positive | None = None


class FrameTable(Table):
    """`[frames.NAME]`: mm, deg (roll, pitch, yaw), seen from the parent frame."""

    parent: str = "FLANGE"
    xyz: list[Number] = [0.0, 0.0, 0.0]
    rpy: list[Number] = [0.0, 0.0, 0.0]


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
    """`[controller]`: times in ms."""

    required = ("axes", "feedback")
    kind: Literal["turbo-pmac"] = "turbo-pmac"
    coordinate_system: Annotated[int, Field(ge=1, le=16)] = 1
    axes: list[str] | None = None
    feedback: list[str] | None = None
    largest_tm: Number = 50.0
    ixx08: Annotated[int, Field(ge=1, le=8_388_607)] = 96
    rotary_words: Annotated[int, Field(ge=48, le=1_000_000)] = 480
    hold_time: Annotated[float, Field(ge=1.0, le=8_388_607.0)] = 250.0
    rapid_share: Annotated[float, Field(ge=0.001, le=1.0)] = 0.1
    i8: Annotated[int, Field(ge=0, le=255)] = 2
    i10: Annotated[int, Field(ge=1, le=8_388_607)] = 3_713_707


class ToleranceTable(Table):
    """`[tolerance]`: mm and deg."""

    position: Annotated[float, Field(ge=LEAST, le=1e6)] = 0.02
    angle: Annotated[float, Field(ge=LEAST, le=180.0)] = 0.002


class RobotTable(Table):
    """The whole file."""

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
    joints: dict[str, JointTable] | None = None
    frames: dict[str, FrameTable] = {}
    positions: dict[str, list[Number]] | None = None
    actuation: ActuationTable | None = None
    motors: MotorsTable | None = None
    controller: ControllerTable | None = None
    tolerance: ToleranceTable = Field(default_factory=ToleranceTable)
