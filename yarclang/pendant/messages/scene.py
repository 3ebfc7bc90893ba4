"""The robot in three dimensions: the visible bodies and their places."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message, Number

MOST_ROWS = 5000
"""Joint positions in one question for placements."""
MOST_JOINTS = 32

Colour = tuple[int, int, int]


class SceneItem(Message):
    """A body, or the border of a zone. Bodies of one name are one body of the collision check."""

    name: str
    kind: Literal["robot", "tool", "obstacle", "zone", "part", "shape"]
    """`shape`: a collision shape of a link or a tool that has another, visual shape."""
    joint: int
    """Number of joints, from the base on, that move the body."""
    pose: tuple[float, ...]
    """(3, 4) base_from_item with all joints at zero, row by row [m]."""
    colour: Colour
    """Red, green, blue, from 0 to 255."""
    opacity: float
    mesh: str
    """Id for /api/scene/mesh/{id}."""
    named: bool
    """True if its name is written at it."""
    begins_s: float | None = None
    ends_s: float | None = None
    """The body exists from `begins_s` until just before `ends_s` of the program's time [s]; null: from the
    beginning, to the end.
    """


class SceneAxes(Message):
    """A frame."""

    name: str
    joint: int
    """Number of joints that move the frame."""
    pose: tuple[float, ...]
    """(3, 4) base_from_frame with all joints at zero, row by row [m]."""
    program: bool
    """True for a frame that only the program declares."""
    matters: bool
    """True for {B}, the followed frame and those that the program uses; without a program, for all."""


class SceneShown(Message):
    """The visible scene. Placements of the joints (`Display.links`) move it."""

    version: str
    """Changes with any other field."""
    title: str
    notes: tuple[str, ...]
    """Items that can't be shown, with reasons."""
    joints: tuple[str, ...]
    items: tuple[SceneItem, ...]
    axes: tuple[SceneAxes, ...]
    tool: str
    """The frame whose path is drawn; empty: the flange's."""
    tool_pose: tuple[float, ...]
    """(3, 4) base_from_tool with all joints at zero, row by row [m]."""
    tool_axis: tuple[float, ...]
    """The last joint's axis with all joints at zero, away from the robot: a camera on the tool looks along
    it.
    """
    low: tuple[float, ...]
    high: tuple[float, ...]
    """The corners of a box around the robot at HOME and all bodies [m]."""
    robot_low: tuple[float, ...]
    robot_high: tuple[float, ...]
    """Corners of a box around the robot alone [m]."""
    eye: tuple[float, ...]
    target: tuple[float, ...]
    """First place of the camera, and the point at which it looks [m]."""
    speeds: tuple[Colour, ...]
    """Colours for speeds, from standing to the fastest one."""
    ghost: Colour
    touching: Colour
    stale: Colour


class Placements(Message):
    """Joint positions [deg or mm], in the order of the robot's joints, for which placements are wanted."""

    joints: Annotated[
        tuple[Annotated[tuple[Number, ...], Field(max_length=MOST_JOINTS)], ...],
        Field(max_length=MOST_ROWS, description=f"at most {MOST_ROWS} lists of numbers"),
    ]
