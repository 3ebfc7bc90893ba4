"""Keep the places of a cell's workpieces between two programs of a session: the next program starts with the
places at which the previous program left them.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache

import numpy as np

from yarclang.cell.model import Cell, Expected, Item, Leaving, Part, Parts, Present, Touch
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.proof import SLACK
from yarclang.collision.scene import scene_of
from yarclang.handling.parts import first_parts
from yarclang.handling.runs import BEFORE
from yarclang.handling.surroundings import surroundings
from yarclang.handling.walk import Followed, Handling
from yarclang.robot.model import Array, Robot

SAME = 1e-5
"""Parts whose poses differ by less than this [m, or entries of a rotation] are at the same place: numbers in
the text of a program are rounded.
"""


@lru_cache(maxsize=64)
def presently(cell: Cell, present: Present) -> Cell:
    """Return a cell with its workpieces as bodies at their current places. Equal states give the same object,
    since other results are cached by the identity of the cell.
    """
    return replace(cell, present=present)


def present_of(cell: Cell) -> Present:
    """Return the state of a cell's workpieces when a program starts."""
    return cell.present or Present(first_parts(cell))


def are_same(one: Parts, other: Parts) -> bool:
    """Return True if all workpieces are at the same places in two states, within `SAME`. The tolerance is
    needed because the place of a workpiece that is put back differs in the last bits.
    """
    if one == other:
        return True
    coming = [{(each.part.body.name, each.number) for each in parts.expected} for parts in (one, other)]
    first, second = (sorted(parts.items, key=_order) for parts in (one, other))
    return (
        one.closed == other.closed
        and coming[0] == coming[1]
        and len(first) == len(second)
        and all(map(is_same, first, second))
    )


def is_same(one: Item, other: Item) -> bool:
    """Return True if a workpiece is at the same place in two states, within `SAME`."""
    return (one.name, one.gripper, one.is_sure) == (other.name, other.gripper, other.is_sure) and np.allclose(
        one.transform, other.transform, rtol=0.0, atol=SAME
    )


def _order(item: Item) -> tuple[str, str, bool, tuple[float, ...]]:
    return item.name, item.gripper or "", item.is_sure, tuple(item.transform[:3, 3].round(3).tolist())


def around_start(cell: Cell | None, *, touching: bool = True) -> Cell | None:
    """Return a cell as it is when a program starts, with its workpieces as obstacles or on the flange.

    Args:
        cell: cell with its workpieces, or None.
        touching: True if the robot may touch the workpieces that it has just taken or put down.
    """
    if cell is None:
        return None
    leaving = cell.present.leaving if cell.present is not None and touching else ()
    return surroundings(cell, first_parts(cell), _touches(leaving))


def present_after(handling: Handling, found: Followed, q: Array | None) -> Present:
    """Return the state in which a program leaves the workpieces.

    Args:
        handling: the program.
        found: the result of following the program's steps.
        q: the robot's joint positions at the end (n,) [rad or m]; None if they aren't known.
    """
    cell = handling.cell
    assert cell is not None, "a cell without parts has nothing to be followed"
    before = cell.present.leaving if cell.present is not None else ()
    leaving = (*before, *(handling.leaving(one) for one in found.grasps.values() if one.moved))
    return beside(handling.robot, cell, Present(found.end, leaving), q)


def beside(robot: Robot, cell: Cell, present: Present, q: Array | None) -> Present:
    """Return a state of the workpieces without the contact exceptions of grippers that have moved away.

    A gripper that has just taken or put down workpieces may touch them. This exception is dropped if all
    bodies keep their distances without it.

    Args:
        robot: robot in the cell.
        cell: cell with the workpieces.
        present: the state, with the exceptions of all grippers that may still be at their workpieces.
        q: the robot's joint positions (n,) [rad or m]; None if they aren't known.
    """
    left = list(dict.fromkeys(present.leaving))
    for one in tuple(left) if q is not None else ():
        rest = [other for other in left if other is not one]
        if q is not None and _is_free(robot, surroundings(cell, present.parts, _touches(rest)), q):
            left = rest
    expected = tuple(replace(one, taken=BEFORE) for one in present.parts.expected)
    return Present(replace(present.parts, expected=expected), tuple(left), present.goes_on)


def _touches(leaving: Collection[Leaving]) -> tuple[Touch, ...]:
    return tuple(touch for one in leaving for touch in one.touches)


def _is_free(robot: Robot, cell: Cell | None, q: Array) -> bool:
    """Return True if all bodies keep their distances at a joint position (n,)."""
    scene = scene_of(robot, cell).value
    if scene is None or not len(scene.pairs.first):
        return True
    pairs = np.arange(len(scene.pairs.first))
    apart = distances(scene, pairs, relative(place(scene, q[None]), np.zeros_like(pairs), pairs))
    return bool((apart >= scene.pairs.margin + SLACK).all())


def on_cell(present: Present, known: Cell, cell: Cell) -> Present:
    """Transfer a state of the workpieces to a cell that was read again from its file. Workpieces are
    identified by their names.

    A workpiece that is still at the initial place of the old file, and a new workpiece, get the place that
    the new file gives. Workpieces that are no longer in the file are removed.

    Args:
        present: the state.
        known: the cell as read before, to which the state belongs.
        cell: the cell as read now.
    """
    if known.parts == cell.parts:
        return present
    kinds, had = {one.body.name: one for one in cell.parts}, {one.body.name for one in known.parts}
    items = [
        replace(_at_home(one, kinds[name]), part=kinds[name])
        for one in present.parts.items
        if (name := one.part.body.name) in kinds
    ]
    items += [one for one in first_parts(cell).items if one.part.body.name not in had]
    expected = tuple(
        Expected(kinds[one.part.body.name], one.number, one.taken)
        for one in present.parts.expected
        if one.part.body.name in kinds
    )
    return replace(present, parts=replace(present.parts, items=tuple(items), expected=expected))


def _at_home(item: Item, kind: Part) -> Item:
    """Return a workpiece at the initial place that the new cell gives its kind, if it was never moved;
    otherwise unchanged.
    """
    if item.gripper is not None or item.pose != item.part.body.mount.transform.tobytes():
        return item
    return replace(item, pose=kind.body.mount.transform.tobytes())
