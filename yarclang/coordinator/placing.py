"""Places of parts as declared by users. No I/O."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.cell.model import Item, Leaving, Parts, Present, Touch
from yarclang.coordinator.kept_parts import Known
from yarclang.handling.grasp import Grasp
from yarclang.handling.parts import first_parts
from yarclang.handling.racks import is_in_place
from yarclang.handling.walk import flange_pose, handling_of
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble

_CODE = "Y1601"


def as_filed(places: Known, name: str | None) -> Known:
    """Return the places of the cell's parts after a user has declared that a part, or several, are in the
    places that the cell's file gives.

    Args:
        places: places of the parts before.
        name: name of the part, or of all parts of a kind; None: all parts.

    Raises:
        Trouble: there is no part with this name.
    """
    first = first_parts(replace(places.cell, present=None))
    if name is None:
        return _with(places, first, _lying(first))
    kind = _kind(places, name)
    items = [one for one in first.items if one.part.body.name == kind]
    return _placed(places, kind, None, items)


def gone(places: Known, name: str) -> Known:
    """Return the places of the cell's parts after a user has declared that a part is no longer in the cell.

    Args:
        places: places of the parts before.
        name: name of the part.

    Raises:
        Trouble: there is no part with this name.
    """
    kind = _kind(places, name)
    return _placed(places, kind, None if name == kind else _number(places, kind, name), [])


def put(places: Known, robot: Robot, name: str, pose: Array, gripper: str | None) -> Known:
    """Return the places of the cell's parts after a user has declared that a part is at a pose or in a
    gripper.

    Args:
        places: places of the parts before, including the robot's position.
        robot: the robot that may hold the part.
        name: name of the part.
        pose: (4, 4) base_from_part [m], or flange_from_part if a gripper holds the part. For a tool, the pose
            of the flange when the tool is in its place.
        gripper: variable of the gripper's output; None: no gripper holds the part.

    Raises:
        Trouble: there is no part with this name, there are several of its kind, or the gripper holds another
            part.
    """
    kind = _kind(places, name)
    number = _number(places, kind, name)
    part = next(one for one in places.cell.parts if one.body.name == kind)
    if part.rack is not None:
        is_held = gripper == part.rack.lock
        if not is_held and (gripper is not None or not is_in_place(part.rack, pose)):
            raise Trouble(
                f"{name} is a tool: it can be only in its place in the rack, or on the flange",
                f"use .parts put {name} and the frame of its place, or .parts put {name} {{FLANGE}}",
                _CODE,
            )
        pose = part.rack.flange_from_body if is_held else part.rack.base_from_body
    elif gripper is not None:
        _check_gripper(places, gripper)
    item = Item(part, number, np.array(pose, dtype=np.float64).tobytes(), gripper)
    for one in places.present.parts.held(gripper) if gripper is not None else ():
        if one.name != item.name:
            raise Trouble(f"the gripper holds {one.name}", f"enter the place of {one.name} first", _CODE)
    after = _placed(places, kind, number, [item])
    if gripper is None:
        return after
    parts = replace(after.present.parts, closed=after.present.parts.closed | {gripper})
    if places.stands is None:
        return _with(after, parts, after.present.leaving)
    handling, grip = handling_of(robot, places.cell, ()), places.cell.grips[gripper]
    before = replace(parts, items=tuple(one for one in parts.items if one is not item))
    grasp = Grasp(0, gripper, grip, True, flange_pose(robot, places.stands), before, parts)
    return _with(after, parts, (*after.present.leaving, handling.leaving(grasp)))


def _check_gripper(places: Known, gripper: str) -> None:
    """Check that a gripper can hold a part.

    Raises:
        Trouble: the gripper is the lock of a tool changer, or belongs to a tool that isn't on the flange.
    """
    grip = places.cell.grips[gripper]
    if grip.changes:
        raise Trouble(
            "the lock of a tool changer holds only tools, not parts", "give the frame of a gripper", _CODE
        )
    if grip.tool is not None and grip.tool not in places.present.parts.tools:
        raise Trouble(
            f"the gripper belongs to {grip.tool}, which isn't on the flange",
            f"put it there first: .parts put {grip.tool} {{FLANGE}}",
            _CODE,
        )


def _placed(places: Known, kind: str, number: int | None, items: list[Item]) -> Known:
    """Return the places of the cell's parts after the given items have replaced a part.

    Args:
        places: places of the parts before.
        kind: kind of the part.
        number: number of the part among those of its kind; None: all parts of the kind.
        items: the new items.
    """
    parts = places.present.parts

    def is_other(name: str, its: int) -> bool:
        return name != kind or number not in (None, its)

    other_items = [one for one in parts.items if is_other(one.part.body.name, one.number)]
    had = {one.gripper for one in parts.items if one not in other_items}
    closed = parts.closed - {
        one for one in had if one is not None and all(each.gripper != one for each in other_items)
    }
    expected = tuple(one for one in parts.expected if is_other(one.part.body.name, one.number))
    closed |= {one.gripper for one in items if one.gripper}
    after = Parts((*other_items, *items), frozenset(closed), expected)
    if len(after.tools) > 1:
        raise Trouble(
            f"{' and '.join(after.tools)} would both be on the flange",
            "first put the other tool into its place (.parts put)",
            _CODE,
        )
    return _with(places, after, (*places.present.leaving, *_lying(replace(after, items=tuple(items)))))


def _with(places: Known, parts: Parts, leaving: tuple[Leaving, ...]) -> Known:
    return replace(places, present=Present(parts, leaving), doubt="")


def _lying(parts: Parts) -> tuple[Leaving, ...]:
    """Return permissions for the robot to touch each part that no gripper holds, as if the robot had just put
    the part down.
    """
    names = [one.name for one in parts.items if one.gripper is None]
    return tuple(Leaving((name,), False, (Touch(name, None, -np.inf),)) for name in names)


def _kind(places: Known, name: str) -> str:
    kinds = [one.body.name for one in places.cell.parts]
    found = next((one for one in kinds if name == one or _is_number_of(name, one)), None)
    if found is None:
        raise Trouble(f"no part is called {name[:40]}", f"there are {', '.join(kinds)}", _CODE)
    return found


def _is_number_of(name: str, kind: str) -> bool:
    return name.startswith(f"{kind} ") and name[len(kind) + 1 :].isdecimal()


def _number(places: Known, kind: str, name: str) -> int:
    """Return the number of a part among the parts of its kind."""
    count = next(one.count for one in places.cell.parts if one.body.name == kind)
    if name != kind:
        number = int(name[len(kind) + 1 :])
        if not 1 <= number <= count:
            raise Trouble(f"there is no {name[:40]}", f"there are {count} of {kind}", _CODE)
        return number
    numbers = sorted({one.number for one in places.present.parts.items if one.part.body.name == kind})
    if len(numbers) > 1:
        names = ", ".join(f"{kind} {one}" for one in numbers[:8])
        raise Trouble(f"{kind} isn't unique: there are several parts", f"name one of {names}", _CODE)
    return numbers[0] if numbers else 1
