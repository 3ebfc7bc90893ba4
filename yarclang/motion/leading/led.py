"""Define the path that is found for a motion, before the motion has a time."""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath, FramePath
from yarclang.motion.path import Path


@frozen(eq=False)
class LineLeg:
    """One leg of a polyline around obstacles: `pose` (4, 4) of the moving frame at its end, the arm's `path`
    to this pose, and its `share` in the duration of all legs.
    """

    pose: Array
    path: CartesianPath
    share: float


@frozen(eq=False)
class Led:
    """The result of finding the path of a motion.

    `path` is None if the motion can't be done. `end` is the joint position at its end, if known. `waypoints`
    (k, n) [rad or m] are the joint positions chosen for its way-points. `broken` is True if the motion can't
    be done from the robot's position, though perhaps from another one. `legs` are the legs of a polyline
    around obstacles; the `path` is then that of the last leg.
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

    After a motion that can't be done, no more than this is known of the motions that follow.
    """

    frame: FramePath
    flange_from_moving: Array
