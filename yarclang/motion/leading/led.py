"""Define the result of routing a motion, before the motion has a time."""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath, FramePath
from yarclang.motion.path import Path


@frozen(eq=False)
class LineLeg:
    """A leg of a line around obstacles: its end `pose` (4, 4) of the moving frame, the `path` that leads
    there, and its `share` in the duration of all legs.
    """

    pose: Array
    path: CartesianPath
    share: float


@frozen(eq=False)
class Led:
    """The routing of a motion.

    `path` is None if the motion can't be done. `end` is its end, if known. `waypoints` (k, n) [rad or m] are
    the joint positions chosen for its way-points. `broken` is True if it can't be done from the robot's
    position, though perhaps from another one. `legs` are those of a line around obstacles.
    """

    path: Path | None
    end: Array | None
    waypoints: Array | None
    broken: bool = False
    legs: tuple[LineLeg, ...] = ()


NOWHERE = Led(None, None, None)


@frozen(eq=False)
class FrameWay:
    """The way of a moving frame with known ends but without joint positions.

    Nothing more is known of a motion after one that can't be done.
    """

    frame: FramePath
    flange_from_moving: Array
