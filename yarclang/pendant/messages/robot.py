"""Messages about the robot: its description, its owner, and the programs of its project."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message
from yarclang.pendant.messages.people import Name


class GiveControl(Message):
    """Id of the session that gets control of the robot (empty: release it). `refuse`: deny the request of
    that session.
    """

    to: Name = ""
    refuse: bool = False


class Asked(Message):
    """Reply to a request for control. `given` is true if control was given at once; `owner` has control now;
    `what` tells in words what comes next.
    """

    given: bool
    owner: str
    what: str


class JointShown(Message):
    """A joint: its unit (deg or mm), its position limits in this unit, its velocity limit in this unit per s,
    and its speed in a jog at 100 %.
    """

    name: str
    unit: str
    lower: float
    upper: float
    velocity: float


class FrameShown(Message):
    """A frame and its pose, a matrix (4, 4) with lengths in m: in {B}, or in the flange's frame for a frame
    on the flange.
    """

    name: str
    pose: tuple[tuple[float, ...], ...]


class RobotShown(Message):
    """The robot: the data with which a page draws bars and lets the user choose frames."""

    name: str
    title: str
    controller: str
    simulated: bool
    folder: str
    cell: str | None
    joints: tuple[JointShown, ...]
    jog_speed_mm_s: float
    jog_turn_deg_s: float
    fixed: tuple[FrameShown, ...]
    """Stationary frames, {B} first."""
    moving: tuple[FrameShown, ...]
    """Frames on the flange, {TCP} first."""


class ProgramFile(Message):
    """A program of the project: its path from the project's folder, its size [bytes], and the time of its
    last change (UTC).
    """

    file: str
    size: int
    changed: str


class Programs(Message):
    """The programs of the project."""

    folder: str
    programs: tuple[ProgramFile, ...]
