"""Frames with their origin, tools and their masses, and what a payload does to the torques of the joints."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Message

Pose = tuple[tuple[float, ...], ...]
Origin = Literal["urdf", "robot.toml", "cell.toml", "session"]

HEAVIEST = 10_000.0
"""Largest mass that is entered [kg]."""
FARTHEST = 5_000.0
"""Farthest a centre of mass lies from its frame, along each axis [mm]."""

ToolName = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,39}$", description="letters, digits and underscores")
]
Mass = Annotated[float, Field(ge=0.0, le=HEAVIEST, allow_inf_nan=False)]
Length = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST, allow_inf_nan=False)]
Moment = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]


class FrameKnown(Message):
    """A frame in braces: (4, 4) its pose in {B}, or, with `on_flange`, in {FLANGE} [m], and where it is
    described.
    """

    name: str
    on_flange: bool
    pose: Pose
    origin: Origin


class ToolKnown(Message):
    """A tool of robot.toml: mass [kg], centre of mass [mm] and inertia [kg m^2] (xx, yy, zz, xy, xz, yz about
    the centre of mass) seen from `frame`; null where it isn't given.
    """

    name: str
    frame: str
    mounted: bool
    mass: float | None
    center_mm: tuple[float, ...] | None
    inertia: tuple[float, ...] | None


class ToolsShown(Message):
    """Frames and tools as the files and the session have them now."""

    frames: tuple[FrameKnown, ...]
    tools: tuple[ToolKnown, ...]
    """As robot.toml has them on the disk."""
    sits_on: tuple[str, ...]
    """The frames on the flange that a tool's mass may be seen from, without braces."""
    file: str
    """robot.toml: its path in the project, or the whole one of a robot outside of it."""
    why_not: str
    """Reason why robot.toml can't be changed here, and the remedy; empty: it can."""
    restart: bool
    """True if robot.toml differs from the running description: it takes effect when the pendant is restarted.
    """
    without_mass: tuple[str, ...]
    """Joints of which nothing that they move has a mass in the URDF."""
    without_effort: tuple[str, ...]
    """Joints whose largest torque neither robot.toml nor the URDF gives."""
    checked: bool
    """True if programs are checked for torques."""


class Payload(Message):
    """Mass properties of a tool: `frame` is for a tool that robot.toml doesn't have yet; `inertia` null: all
    of its mass is assumed at its centre. With `program`, the number of a loaded program, its torques are
    included.
    """

    tool: ToolName
    frame: ToolName | None = None
    mass: Mass
    center_mm: tuple[Length, Length, Length] = (0.0, 0.0, 0.0)
    inertia: tuple[Moment, Moment, Moment, Moment, Moment, Moment] | None = None
    program: Annotated[int | None, Field(ge=0, le=1_000_000_000)] = None


class SavePayload(Payload):
    """A payload that is written into robot.toml, which has the content that was shown."""

    known: Annotated[str, Field(pattern="^[0-9a-f]{64}$", description="SHA-256 of robot.toml")]


class JointEffort(Message):
    """A joint, and the largest torque that its motor gives; null: not known."""

    name: str
    unit: str
    effort: float | None


class Torques(Message):
    """Torques of all joints without and with the payload, in the joints' order.

    `here`: at rest where the robot stands. `reach`: at rest, the largest within the joint limits. `program`:
    the largest while the program moves.
    """

    what: Literal["here", "reach", "program"]
    now: tuple[float, ...]
    then: tuple[float, ...]
    at: tuple[tuple[float, ...], ...]
    """Of each joint the joint positions [deg or mm] at which its torque is the largest, with the payload."""
    where: tuple[str, ...]
    """For each joint the command of the program in which its torque is the largest; empty: no program is
    given.
    """


class PayloadShown(Message):
    """Changes that a payload would make: of the file, and of the torques."""

    file: str
    why_not: str
    before: str
    after: str
    known: str
    """SHA-256 of the present file."""
    findings: tuple[Finding, ...]
    """Of the changed file."""
    sound: bool
    """True if the changed file can be used."""
    joints: tuple[JointEffort, ...]
    torques: tuple[Torques, ...]
    unknown: str
    """Reason why torques are missing; empty: they aren't."""
    restart: bool


class PayloadWritten(Message):
    """robot.toml was changed; it takes effect when the pendant is restarted."""

    file: str
    sha256: str
    restart: bool
