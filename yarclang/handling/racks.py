"""Compute which tool is on the flange after a tool changer has locked or unlocked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.cell.model import Item, Parts, RackTool
from yarclang.frozen import frozen
from yarclang.shapes import Array
from yarclang.units import DEG

MOST_TURN = 0.5 * DEG
"""Largest angle between the flange and a tool's place at which the changer can lock or unlock [rad]."""


@frozen
class Nearest:
    """The workpiece nearest to a gripper that closes, with its distance.

    Attributes:
        item: the workpiece or tool.
        distance: distance of the workpiece's surface from the gripper's origin [m], 0 if the origin is
            inside; for a tool, the distance of the flange from the tool's place in the rack.
    """

    item: Item
    distance: float


def apart(tool: RackTool, base_from_flange: Array) -> tuple[float, float]:
    """Return the distance [m] and the angle [rad] between a flange pose (4, 4) and a tool's place."""
    away = np.linalg.inv(tool.place.transform) @ base_from_flange
    cosine = np.clip((np.trace(away[:3, :3]) - 1.0) / 2.0, -1.0, 1.0)
    # the arc cosine alone would lose half of the digits of a small angle
    sine = np.linalg.norm(away[:3, :3] - away[:3, :3].T) / np.sqrt(8.0)
    return float(np.linalg.norm(away[:3, 3])), float(np.arctan2(sine, cosine))


def is_in_place(tool: RackTool, base_from_flange: Array) -> bool:
    """Return True if the flange is at a tool's place."""
    distance, turn = apart(tool, base_from_flange)
    return distance <= tool.reach and turn <= MOST_TURN


def nearest_tool(parts: Parts, base_from_flange: Array) -> Nearest | None:
    """Return the tool in its rack whose place is nearest to the flange; None if no tool is in a rack."""
    found = [
        Nearest(one, apart(one.part.rack, base_from_flange)[0])
        for one in parts.items
        if one.part.rack is not None and one.gripper is None
    ]
    return min(found, key=lambda one: one.distance, default=None)


def locked(parts: Parts, lock: str, base_from_flange: Array) -> Parts:
    """Lock a tool changer at a flange pose (4, 4): the changer picks up the tool whose place in the rack
    is at this pose.
    """
    items = tuple(
        replace(one, pose=one.part.rack.flange_from_body.tobytes(), gripper=lock)
        if one.part.rack is not None and not parts.held(lock) and _stands_there(one, base_from_flange)
        else one
        for one in parts.items
    )
    return replace(parts, items=items, closed=parts.closed | {lock})


def _stands_there(item: Item, base_from_flange: Array) -> bool:
    rack = item.part.rack
    assert rack is not None  # the caller has checked it
    stands = item.gripper is None and item.pose == rack.base_from_body.tobytes()
    return stands and is_in_place(rack, base_from_flange)


def unlocked(parts: Parts, lock: str, base_from_flange: Array) -> Parts:
    """Unlock a tool changer at a flange pose (4, 4). If the flange is at the tool's place, the tool is put
    into exactly this place. Otherwise the tool, and everything that its grippers hold, stays where it is.
    """
    left = [one for one in parts.held(lock) if one.part.rack is not None]
    if not left:
        return parts
    open_now = {variable for one in left if one.part.rack is not None for variable in one.part.rack.grippers}

    def after(one: Item) -> Item:
        if one in left and one.part.rack is not None and is_in_place(one.part.rack, base_from_flange):
            return replace(one, pose=one.part.rack.base_from_body.tobytes(), gripper=None)
        if one in left or one.gripper in open_now:
            return replace(one, pose=(base_from_flange @ one.transform).tobytes(), gripper=None)
        return one

    return replace(parts, items=tuple(map(after, parts.items)))
