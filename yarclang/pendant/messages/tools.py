"""Messages about frames and the places of their declarations, about tools and their masses, and about the
effect of a payload on joint torques.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Message

Pose = tuple[tuple[float, ...], ...]
Origin = Literal["urdf", "robot.toml", "cell.toml", "session"]

HEAVIEST = 10_000.0
"""Largest mass that can be entered [kg]."""
FARTHEST = 5_000.0
"""Largest distance of a center of mass from its frame, along each axis [mm]."""

ToolName = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,39}$", description="letters, digits and underscores")
]
Mass = Annotated[float, Field(ge=0.0, le=HEAVIEST, allow_inf_nan=False)]
Length = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST, allow_inf_nan=False)]
Moment = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]


class FrameKnown(Message):
    """A frame: its name in braces, its pose, and the place of its declaration. The pose is a matrix (4, 4)
    with lengths in m. It is relative to {FLANGE} if `on_flange` is true, otherwise to {B}.
    """

    name: str
    on_flange: bool
    pose: Pose
    origin: Origin


class ToolKnown(Message):
    """A tool of robot.toml: its mass [kg], its center of mass in `frame` [mm], and its inertia about the
    center of mass in the axes of `frame` [kg m^2] (xx, yy, zz, xy, xz, yz). Each value is null if robot.toml
    doesn't contain it.
    """

    name: str
    frame: str
    mounted: bool
    mass: float | None
    center_mm: tuple[float, ...] | None
    inertia: tuple[float, ...] | None


class ToolsShown(Message):
    """Present frames and tools, from the files and the session."""

    frames: tuple[FrameKnown, ...]
    tools: tuple[ToolKnown, ...]
    """Tools as in the robot.toml on the disk."""
    sits_on: tuple[str, ...]
    """Frames on the flange, without braces, in which a tool's center of mass can be given."""
    file: str
    """Path of robot.toml in the project, or its absolute path if it is outside of the project."""
    why_not: str
    """Reason why robot.toml can't be changed here, and the remedy; empty: it can."""
    restart: bool
    """True if robot.toml differs from the description that the pendant uses. The file takes effect after a
    restart.
    """
    without_mass: tuple[str, ...]
    """Joints for which no moved body has a mass in the URDF."""
    without_effort: tuple[str, ...]
    """Joints without a largest torque in robot.toml and in the URDF."""
    checked: bool
    """True if the torques of programs are checked."""


class Payload(Message):
    """Mass properties of a tool. `frame` is needed only if the tool isn't in robot.toml yet. `inertia` null:
    the whole mass is assumed to be at its center. `program` is the number of a loaded program; its torques
    are computed as well.
    """

    tool: ToolName
    frame: ToolName | None = None
    mass: Mass
    center_mm: tuple[Length, Length, Length] = (0.0, 0.0, 0.0)
    inertia: tuple[Moment, Moment, Moment, Moment, Moment, Moment] | None = None
    program: Annotated[int | None, Field(ge=0, le=1_000_000_000)] = None


class SavePayload(Payload):
    """Request to write a payload into robot.toml. The file must still have the content that was shown."""

    known: Annotated[str, Field(pattern="^[0-9a-f]{64}$", description="SHA-256 of robot.toml")]


class JointEffort(Message):
    """A joint, and the largest torque of its motor; null: not known."""

    name: str
    unit: str
    effort: float | None


class Torques(Message):
    """Torques of all joints without and with the payload, in the order of the joints.

    `here`: at rest at the robot's present position. `reach`: largest torques at rest anywhere within the
    joint limits. `program`: largest torques during the program.
    """

    what: Literal["here", "reach", "program"]
    now: tuple[float, ...]
    then: tuple[float, ...]
    at: tuple[tuple[float, ...], ...]
    """For each joint, the joint positions [deg or mm] at which its torque with the payload is largest."""
    where: tuple[str, ...]
    """For each joint, the command of the program in which its torque is largest; empty: no program is
    given.
    """


class PayloadShown(Message):
    """Effects of a payload: the change of the file, and the change of the torques."""

    file: str
    why_not: str
    before: str
    after: str
    known: str
    """SHA-256 of the present file."""
    findings: tuple[Finding, ...]
    """Findings of the changed file."""
    sound: bool
    """True if the changed file can be used."""
    joints: tuple[JointEffort, ...]
    torques: tuple[Torques, ...]
    unknown: str
    """Reason why torques are missing; empty: none is missing."""
    restart: bool


class PayloadWritten(Message):
    """Reply after robot.toml was changed. The change takes effect after a restart of the pendant."""

    file: str
    sha256: str
    restart: bool
