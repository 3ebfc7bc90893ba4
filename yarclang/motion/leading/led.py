"""What is known of a motion before it has a time."""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import FramePath
from yarclang.motion.path import Path


@frozen(eq=False)
class Led:
    """The path of a motion (None where it can't be done), where it ends if that is known, and the joint positions (k, n) that were chosen for its
    way-points [rad or m]. `broken` says that it can't be done from where the robot stands, though perhaps from elsewhere.
    """

    path: Path | None
    end: Array | None
    waypoints: Array | None
    broken: bool = False


NOWHERE = Led(None, None, None)


@frozen(eq=False)
class FrameWay:
    """The way of a moving frame whose ends are known, though no joint positions are: what there is of a motion behind one that can't be done."""

    frame: FramePath
    flange_from_moving: Array
