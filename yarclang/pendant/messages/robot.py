"""Messages about the robot: what it is, who controls it, the programs of its project."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message
from yarclang.pendant.messages.people import Name


class GiveControl(Message):
    """Id of the session that gets control of the robot (empty: release it); `refuse`: deny that session's
    request.
    """

    to: Name = ""
    refuse: bool = False


class Asked(Message):
    """Control was asked for; `given` is true if it was given at once, `owner` who has it now, `what` in words
    what comes next.
    """

    given: bool
    owner: str
    what: str


class JointShown(Message):
    """A joint, its unit (deg or mm), limits of position in this unit and of velocity per s, and its speed in
    a jog at 100 %.
    """

    name: str
    unit: str
    lower: float
    upper: float
    velocity: float


class FrameShown(Message):
    """A frame: (4, 4) its pose in {B}, or, if it sits on the flange, in the flange's frame [m]."""

    name: str
    pose: tuple[tuple[float, ...], ...]


class RobotShown(Message):
    """The robot: what a page needs to draw bars and choose frames."""

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
    """Frames that stand still, {B} first."""
    moving: tuple[FrameShown, ...]
    """Frames on the flange, {TCP} first."""


class ProgramFile(Message):
    """A program of the project: its path from the project's folder, its size [bytes], and when it was changed
    (UTC).
    """

    file: str
    size: int
    changed: str


class Programs(Message):
    """The programs of the project."""

    folder: str
    programs: tuple[ProgramFile, ...]
