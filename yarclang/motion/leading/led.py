"""Define the result of finding a motion's path. The motion has no times yet."""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath, FramePath
from yarclang.motion.path import Path


@frozen(eq=False)
class LineLeg:
    """One leg of a polyline around obstacles.

    `pose` (4, 4) is the pose of the moving frame at the leg's end, and `path` the arm's path to it. `share`
    is the leg's share of the duration of all legs.
    """

    pose: Array
    path: CartesianPath
    share: float


@frozen(eq=False)
class Led:
    """The result of finding the path of a motion.

    `path` is None if the motion can't be executed. `end` is the joint position at its end, if known.
    `waypoints` (k, n) [rad or m] are the joint positions chosen for its waypoints. `broken` is True if the
    motion can't be executed from the robot's position, though perhaps from another one. `legs` are the legs
    of a polyline around obstacles; `path` is then the path of the last leg.
    """

    path: Path | None
    end: Array | None
    waypoints: Array | None
    broken: bool = False
    legs: tuple[LineLeg, ...] = ()


NOWHERE = Led(None, None, None)


@frozen(eq=False)
class FrameWay:
    """The path of a moving frame with known ends but without joint positions.

    After a motion that can't be executed, the robot's joint position isn't known. The following motions are
    then described by such paths.
    """

    frame: FramePath
    flange_from_moving: Array
