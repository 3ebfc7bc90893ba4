"""The robot in three dimensions: the visible bodies and their places."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message, Number

MOST_ROWS = 5000
"""Largest number of joint positions in one request for placements."""
MOST_JOINTS = 32

Colour = tuple[int, int, int]


class SceneItem(Message):
    """A body, or the border of a zone. All items with the same name are one body in the collision check."""

    name: str
    kind: Literal["robot", "tool", "obstacle", "zone", "part", "shape"]
    """`shape`: a collision shape of a link or a tool for which there is also a visual shape."""
    joint: int
    """Number of joints between the base and the body: the first `joint` joints move it."""
    pose: tuple[float, ...]
    """Matrix (3, 4) base_from_item with all joints at zero, row by row, lengths in m."""
    colour: Colour
    """Red, green and blue, each from 0 to 255."""
    opacity: float
    mesh: str
    """Id of the mesh, for /api/scene/mesh/{id}."""
    named: bool
    """True if pages write the name beside the item."""
    begins_s: float | None = None
    ends_s: float | None = None
    """Time at which the item disappears. The item exists from `begins_s` until just before `ends_s`, both in
    the program's time [s]. Null: from the program's beginning, or to its end.
    """


class SceneAxes(Message):
    """A frame whose axes are drawn."""

    name: str
    joint: int
    """Number of joints between the base and the frame: the first `joint` joints move it."""
    pose: tuple[float, ...]
    """Matrix (3, 4) base_from_frame with all joints at zero, row by row, lengths in m."""
    program: bool
    """True for a frame that only the program declares."""
    matters: bool
    """True for the important frames: {B}, the followed frame and the frames that the program uses. Without a
    program, all frames are important.
    """


class SceneShown(Message):
    """The visible scene. Pages move its bodies by the displacements of the joints (`Display.links`)."""

    version: str
    """Value that changes when any other field changes."""
    title: str
    notes: tuple[str, ...]
    """Items that can't be shown, with reasons."""
    joints: tuple[str, ...]
    items: tuple[SceneItem, ...]
    axes: tuple[SceneAxes, ...]
    tool: str
    """The frame whose path is drawn; empty: the path of the flange is drawn."""
    tool_pose: tuple[float, ...]
    """Matrix (3, 4) base_from_tool with all joints at zero, row by row, lengths in m."""
    tool_axis: tuple[float, ...]
    """Direction of the last joint's axis with all joints at zero, pointing away from the robot. A camera on
    the tool looks in this direction.
    """
    low: tuple[float, ...]
    high: tuple[float, ...]
    """Upper corner of a box around the robot at HOME and all bodies [m]. `low` is its lower corner."""
    robot_low: tuple[float, ...]
    robot_high: tuple[float, ...]
    """Upper corner of a box around the robot alone [m]. `robot_low` is its lower corner."""
    eye: tuple[float, ...]
    target: tuple[float, ...]
    """Point at which the camera looks first [m]."""
    speeds: tuple[Colour, ...]
    """Colours for speeds, from rest to the highest speed."""
    ghost: Colour
    touching: Colour
    stale: Colour


class Placements(Message):
    """Request for the displacements of the links at given joint positions [deg or mm], in the order of the
    robot's joints.
    """

    joints: Annotated[
        tuple[Annotated[tuple[Number, ...], Field(max_length=MOST_JOINTS)], ...],
        Field(max_length=MOST_ROWS, description=f"at most {MOST_ROWS} lists of numbers"),
    ]
