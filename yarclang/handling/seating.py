"""Detect likely mistakes in the description of a cell's workpieces: the body on which a workpiece lies at the
start, and how deep a gripper enters the workpiece.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import Cell, Item, Parts, Touch
from yarclang.collision.geometry import UnreadableError, geometry_of
from yarclang.collision.placing import Relative, distances
from yarclang.collision.scene import Body, Scene, scene_of
from yarclang.handling.grasp import Grasp
from yarclang.handling.surroundings import surroundings
from yarclang.robot.model import Array, Robot

DEEP = 5e-3
"""Largest depth to which the cup of a vacuum gripper may enter the part that it takes [m]. More is reported
as a likely mistake. A gripper without a vacuum sensor may be deeper by half of the part's thickness.
"""


def first_of(grasp: Grasp) -> tuple[Item, ...]:
    """Return the workpieces that a gripper picks up from their initial places in the cell; of each kind only
    the first workpiece.
    """
    return tuple(
        one
        for one in grasp.before.items
        if grasp.closes
        and one.name in grasp.moved
        and one.number == 1
        and one.pose == one.part.body.mount.transform.tobytes()
    )


def nearest_to(robot: Robot, cell: Cell, grasp: Grasp, name: str) -> Touch | None:
    """Find the body nearest to a workpiece when a gripper takes the workpiece.

    Args:
        robot: robot in the cell.
        cell: cell as in its file.
        grasp: grasp that takes the workpiece.
        name: name of the workpiece.

    Returns:
        The body, and its distance as `least` [m], negative if both overlap; None if there is no other body at
        rest.
    """
    found = _gaps(
        robot,
        cell,
        grasp.after,
        grasp.base_from_flange,
        lambda still: still.joint == 0,
        lambda moved: moved.is_part and moved.name == name and not moved.of_cell,
    )
    return min(found, key=lambda one: one.least, default=None)


def deepest(robot: Robot, cell: Cell, grasp: Grasp, name: str) -> Touch | None:
    """Find the body on the flange that is deeper in a workpiece than a gripper should be when it closes.

    A suction cup lies on the workpiece. Fingers reach around it. In the model, fingers are often one body
    without a gap; such a body overlaps the workpiece, but hardly beyond its middle.

    Args:
        robot: robot in the cell.
        cell: cell as in its file.
        grasp: grasp that takes the workpiece.
        name: name of the workpiece.

    Returns:
        The workpiece as `part`, the body as `other`, and minus the overlap as `least` [m]; None if nothing is
        too deep.
    """
    item = next(one for one in grasp.before.items if one.name == name)
    is_cup = any(one.gripper == grasp.variable for one in cell.sensors)
    allowed = DEEP if is_cup else DEEP + _half_thickness(item)
    found = _gaps(
        robot,
        cell,
        grasp.before,
        grasp.base_from_flange,
        lambda still: still.is_part and still.of_cell and still.name == name,
        lambda moved: moved.joint == robot.size and moved.may_hold,
    )
    worst = min(found, key=lambda one: one.least, default=None)
    if worst is None or worst.least >= -allowed:
        return None
    return Touch(name, worst.part, worst.least)


def _half_thickness(item: Item) -> float:
    """Return half of the shortest edge of the box around a workpiece [m]; infinite for a mesh that can't be
    read.
    """
    try:
        return float(geometry_of(item.part.body.shape).half.min())
    except UnreadableError:  # the collision check reports the mesh
        return np.inf


def _gaps(
    robot: Robot,
    cell: Cell,
    parts: Parts,
    base_from_flange: Array,
    is_still: Callable[[Body], bool],
    is_moved: Callable[[Body], bool],
) -> list[Touch]:
    """Return the distances of bodies at rest (`other`) from bodies on the flange (`part`); empty without
    bodies that could collide.

    Args:
        robot: robot in the cell.
        cell: cell as in its file.
        parts: where the workpieces are.
        base_from_flange: (4, 4) pose of the flange.
        is_still: function that selects bodies at rest.
        is_moved: function that selects bodies on the flange.
    """
    scene = scene_of(robot, surroundings(cell, parts)).value
    if scene is None:
        return []
    still, moved = _which(scene, is_still), _which(scene, is_moved)
    pairs = np.flatnonzero(still[scene.pairs.first] & moved[scene.pairs.second])
    first, second = scene.pairs.first[pairs], scene.pairs.second[pairs]
    way = base_from_flange @ np.linalg.inv(robot.chain.base_from_flange)
    back = scene.boxes.rotation[first].transpose(0, 2, 1)
    apart = scene.boxes.middle[second] @ way[:3, :3].T + way[:3, 3] - scene.boxes.middle[first]
    seen = Relative(back @ way[:3, :3] @ scene.boxes.rotation[second], (back @ apart[:, :, None])[:, :, 0])
    gaps = distances(scene, pairs, seen)
    return [Touch(*scene.names(pair), float(gap)) for pair, gap in zip(pairs.tolist(), gaps, strict=True)]


def _which(scene: Scene, wanted: Callable[[Body], bool]) -> NDArray[np.bool_]:
    return np.array([wanted(one) for one in scene.bodies], dtype=np.bool_)
