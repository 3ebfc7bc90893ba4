"""Compute where the workpieces of a cell are, and what changes when a gripper closes or opens.

A state is a set of places at which workpieces may be. After a WHEN one workpiece may have several places; all
of them count as occupied.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from yarclang.cell.model import Cell, Expected, Grip, Item, Part, Parts, Removal
from yarclang.collision.geometry import UnreadableError, geometry_of
from yarclang.handling.racks import Nearest, locked, nearest_tool, unlocked
from yarclang.shapes import Array, Shape, Sphere

BUILT_IN = ""
"""Value of `Item.gripper` for parts that are on the flange from the start and that no output releases."""


NO_PARTS = Parts(())


@lru_cache(maxsize=64)
def first_parts(cell: Cell | None) -> Parts:
    """Return where the workpieces of a cell are when a program starts."""
    if cell is None or not cell.parts:
        return NO_PARTS
    if cell.present is not None:
        return cell.present.parts
    items = []
    for part in cell.parts:
        mount = part.body.mount
        holder = _holder(cell, part) if mount.on_flange else None
        items.append(Item(part, 1, mount.transform.tobytes(), holder))
    return Parts(tuple(items), frozenset(one.gripper for one in items if one.gripper))


def _holder(cell: Cell, part: Part) -> str:
    """Return the tool changer's lock that holds a tool or, for a workpiece on the flange, the nearest
    gripper.
    """
    if part.rack is not None:
        return part.rack.lock
    flange_from_part = part.body.mount.transform
    apart = {
        variable: float(np.linalg.norm(grip.flange_from_grip[:3, 3] - flange_from_part[:3, 3]))
        for variable, grip in cell.grips.items()
        if not grip.changes
    }
    return min(apart, key=apart.__getitem__) if apart else BUILT_IN


def nearest_part(parts: Parts, grip: Grip, base_from_flange: Array) -> Nearest | None:
    """Return the workpiece that a gripper would take at a flange pose (4, 4), at any distance; None if no
    workpiece lies in the cell.

    If the gripper's origin is inside several workpieces, the one with the nearest origin is returned.
    """
    origin = (base_from_flange @ grip.flange_from_grip)[:3, 3]
    found = [
        (
            _distance(one.part.body.shape, one.transform, origin),
            float(np.linalg.norm(one.transform[:3, 3] - origin)),
            at,
        )
        for at, one in enumerate(parts.items)
        if one.gripper is None and one.part.rack is None
    ]
    if not found:
        return None
    distance, _, at = min((max(gap, 0.0), away, at) for gap, away, at in found)
    return Nearest(parts.items[at], distance)


def _distance(shape: Shape, base_from_shape: Array, point: Array) -> float:
    """Return the distance of a point (3,) from a shape [m]; negative inside."""
    there = np.eye(4)
    there[:3, 3] = point
    return _between(shape, base_from_shape, Sphere(_POINT), there) + _POINT


def _between(one: Shape, base_from_one: Array, other: Shape, base_from_other: Array) -> float:
    """Return the distance of the convex hulls of two shapes [m]; negative if they overlap."""
    import coal

    try:
        first, second = _hull(one), _hull(other)
    except UnreadableError:  # the collision check reports the mesh
        return float("inf")
    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = True
    here, there = (coal.Transform3s(pose[:3, :3], pose[:3, 3]) for pose in (base_from_one, base_from_other))
    return float(coal.distance(first, here, second, there, request, answer))


_POINT = 1e-6
"""Radius of the sphere that represents a point [m]."""


@lru_cache(maxsize=256)
def _hull(shape: Shape) -> object:
    return geometry_of(shape, hull=True).of_coal


def close(
    parts: Parts, variable: str, grip: Grip, base_from_flange: Array, step: int
) -> tuple[Parts, Nearest | None]:
    """Close a gripper, and return where the workpieces are afterwards.

    Args:
        parts: where the workpieces are before.
        variable: variable of the gripper's output.
        grip: the gripper.
        base_from_flange: (4, 4) pose of the flange.
        step: the step of the program that closes the gripper.

    Returns:
        Where the workpieces are afterwards, and the one nearest to the gripper, which is held if it was
        within reach. The lock of a tool changer takes a tool if the flange is at the tool's place. A gripper
        of a tool that isn't on the flange takes nothing.
    """
    if grip.changes:
        return locked(parts, variable, base_from_flange), nearest_tool(parts, base_from_flange)
    if grip.tool is not None and grip.tool not in parts.tools:
        return replace(parts, closed=parts.closed | {variable}), None
    near = nearest_part(parts, grip, base_from_flange)
    closed = parts.closed | {variable}
    if near is None or near.distance > grip.reach:
        return replace(parts, closed=closed), near
    item = near.item
    flange_from_part = np.linalg.inv(base_from_flange) @ item.transform
    taken = replace(item, pose=flange_from_part.tobytes(), gripper=variable)
    items = tuple(taken if one is item else one for one in parts.items)
    # if the part was put back at its initial place earlier, and is taken from there again, the next part
    # comes only after this new SET
    expected = tuple(
        dict.fromkeys(replace(one, taken=step) if _blocks(item, one) else one for one in parts.expected)
    )
    is_first_place = item.pose == item.part.body.mount.transform.tobytes()
    if is_first_place and item.number < item.part.count and not any(_blocks(item, one) for one in expected):
        expected = (*expected, Expected(item.part, item.number + 1, step))
    return Parts(items, closed, expected), near


def open_(parts: Parts, variable: str, base_from_flange: Array) -> Parts:
    """Open a gripper at a flange pose (4, 4). The workpieces that it holds stay where they are. If a tool
    changer releases a tool at the tool's place, the tool is put into exactly this place.
    """
    parts = unlocked(parts, variable, base_from_flange)
    items = tuple(
        replace(one, pose=(base_from_flange @ one.transform).tobytes(), gripper=None)
        if one.gripper == variable
        else one
        for one in parts.items
    )
    return replace(parts, items=items, closed=parts.closed - {variable})


def shift(parts: Parts, names: Collection[str], moved: Array, taken: int) -> Parts:
    """Move workpieces that haven't left their initial places. The next workpieces of the same kinds come to
    the unmoved initial places.

    Args:
        parts: where the workpieces are.
        names: names of the kinds of workpieces that are moved.
        moved: (4, 4) displacement in {B} [m].
        taken: step after which the next workpieces may come; it becomes `Expected.taken`.
    """
    items: list[Item] = []
    expected = list(parts.expected)
    for one in parts.items:
        place = one.part.body.mount
        is_there = one.gripper is None and one.pose == place.transform.tobytes()
        if one.part.body.name not in names or place.on_flange or not is_there:
            items.append(one)
            continue
        items.append(replace(one, pose=np.ascontiguousarray(moved @ one.transform).tobytes()))
        if one.number < one.part.count:
            expected.append(Expected(one.part, one.number + 1, taken))
    return replace(parts, items=tuple(items), expected=tuple(expected))


def remove(parts: Parts, removal: Removal) -> Parts:
    """Remove the workpieces that are within the reach of a machine."""
    origin = removal.base_from_place[:3, 3]
    items = tuple(
        one
        for one in parts.items
        if one.gripper is not None
        or one.part.rack is not None
        or _distance(one.part.body.shape, one.transform, origin) > removal.reach
    )
    return replace(parts, items=items)


def arrive(parts: Parts, leaving: Collection[int]) -> Parts:
    """Let the next workpieces come to the places from which the previous ones were taken.

    Args:
        parts: where the workpieces are.
        leaving: SETs that closed a gripper, and from which the robot is still departing on a straight path.
            The places of the workpieces that these SETs took stay empty for now.
    """
    lying = [one for one in parts.items if one.gripper is None and one.part.rack is None and one.is_sure]
    here = [
        one
        for one in parts.expected
        if one.taken not in leaving and not any(_blocks(each, one) for each in lying)
    ]
    if not here:
        return parts
    new = [Item(one.part, one.number, one.part.body.mount.transform.tobytes()) for one in here]
    known = {one.name for one in parts.items}
    return replace(
        parts,
        # the next part may be expected twice: both branches of a WHEN may have taken the previous one, by
        # different SETs
        items=(*parts.items, *(one for one in dict.fromkeys(new) if one.name not in known)),
        expected=tuple(one for one in parts.expected if one not in here),
    )


def _blocks(item: Item, expected: Expected) -> bool:
    """Return True if the workpiece that precedes `expected` still occupies the place to which `expected`
    is to come.
    """
    kind, place = expected.part, expected.part.body
    is_before = item.part.body.name == place.name and item.number == expected.number - 1
    return (
        is_before
        and item.gripper is None
        and _between(item.part.body.shape, item.transform, kind.body.shape, place.mount.transform) < -_DEEP
    )


_DEEP = 1e-3
"""Overlap above which two parts can't be in the cell at the same time [m]."""


def either(one: Parts, other: Parts) -> Parts:
    """Return the state of the workpieces after two branches of which either may have been executed: the union
    of both states.
    """
    if one == other:
        return one
    there = tuple(next((each for each in one.items if _are_alike(each, item)), item) for item in other.items)
    both = set(one.items) & set(there)
    items = [item if item in both else replace(item, is_sure=False) for item in (*one.items, *there)]
    return Parts(
        tuple(dict.fromkeys(items)),
        one.closed & other.closed,
        tuple(dict.fromkeys((*one.expected, *other.expected))),
    )


def unlike(first: Parts, again: Parts) -> str:
    """Return the name of a workpiece or gripper that differs between two states. If there is none, the result
    is empty, and a loop can begin another pass.

    The next workpiece of a kind counts as equal to the previous one.
    """
    one, other = (arrive(parts, frozenset()) for parts in (first, again))
    left = list(other.items)
    for item in one.items:
        found = next((at for at, each in enumerate(left) if _are_one_kind(item, each)), None)
        if found is None:
            return item.name
        left.pop(found)
    if left:
        return left[0].name
    if one.closed != other.closed:
        return "the gripper"
    kinds = [sorted(each.part.body.name for each in parts.expected) for parts in (one, other)]
    return "" if kinds[0] == kinds[1] else (kinds[0] or kinds[1])[0]


def _are_one_kind(one: Item, other: Item) -> bool:
    return one.part == other.part and _are_alike(replace(one, number=other.number), other)


def _are_alike(one: Item, other: Item) -> bool:
    """Return True if two items are the same workpiece at the same place except for rounding, such as a
    workpiece that was put down and taken again at the same place.
    """
    return (one.name, one.gripper, one.is_sure) == (other.name, other.gripper, other.is_sure) and bool(
        (np.abs(one.transform - other.transform) <= _ALIKE).all()
    )


_ALIKE = 1e-7
"""Poses that differ by less than this [m, or entries of a rotation] count as equal. Proofs keep a reserve
that is a hundred times as large (`yarclang.collision.proof.SLACK`).
"""


def doubtful(parts: Parts) -> Iterator[str]:
    """Yield the names of workpieces that may be at several places."""
    names = [one.name for one in parts.items]
    yield from dict.fromkeys(name for name in names if names.count(name) > 1)
