"""Messages about the robot: its description, its owner, and the programs of its project."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message
from yarclang.pendant.messages.people import Name


class GiveControl(Message):
    """Order to give control of the robot to the session `to` (empty: release the robot). With `refuse`, the
    session `to` gets a refusal of its request for control instead.
    """

    to: Name = ""
    refuse: bool = False


class Asked(Message):
    """Reply to a request for control. `given` is true if control was given at once. `owner` has control now.
    `what` says what happens next.
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
    """A frame and its pose, a matrix (4, 4) with lengths in m. The pose is relative to {B}, or to the flange
    for a frame on the flange.
    """

    name: str
    pose: tuple[tuple[float, ...], ...]


class RobotShown(Message):
    """The robot, described so that a page can draw a bar for each joint and offer the frames
    for selection.
    """

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
