"""Build the cell at one instant of a program. Workpieces are obstacles while they lie in the cell, and
carried bodies while a gripper holds them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from yarclang.cell.keeping import Keep
from yarclang.cell.model import Cell, Item, Mount, Obstacle, Parts, Touch, Zone
from yarclang.collision.geometry import UnreadableError, geometry_of
from yarclang.collision.placing import Relative, distances, place, relative
from yarclang.collision.scene import scene_of
from yarclang.handling.parts import doubtful
from yarclang.robot.masses import with_load
from yarclang.robot.model import Array, Dynamics, Robot
from yarclang.shapes import Box, Capsule, Cylinder, Shape, Sphere
from yarclang.source import SourceFile
from yarclang.transforms import constant

PRESSED = 5e-4
"""Distance [m] by which two bodies may be closer to each other during the approach and the retreat than at
the moment when the part is taken or put down.
"""
INTO = 1e-3
"""Depth to which a part may be put into a body that carries it [m], since drawings aren't exact."""
NEAR = 0.02
"""Bodies don't carry a part if their distance from it exceeds the margin by more than this length [m]."""


NO_PAIRS: frozenset[tuple[str, str]] = frozenset()


def surroundings(
    cell: Cell | None,
    parts: Parts,
    touches: tuple[Touch, ...] = (),
    allowed: frozenset[tuple[str, str]] = NO_PAIRS,
    keeps: tuple[Keep, ...] = (),
) -> Cell | None:
    """Return the cell with its workpieces as bodies at their current places. Calls with equal arguments
    return the same object.

    Args:
        cell: cell as in its file.
        parts: where the workpieces are.
        touches: the bodies that may touch each other where a workpiece is taken or put down.
        allowed: the pairs of bodies, by name, that may touch because the program or the cell allows it.
        keeps: the path constraints (KEEP rules) of the program for a motion; each becomes one more zone.
    """
    if cell is None:
        return _without_cell(allowed, keeps) if allowed or keeps else None
    if not cell.parts and not allowed and not keeps:
        return cell
    return _surroundings(cell, parts.items, touches, allowed, keeps)


@lru_cache(maxsize=64)
def _without_cell(allowed: frozenset[tuple[str, str]], keeps: tuple[Keep, ...]) -> Cell:
    """Return an empty cell for a program without one, with the pairs of the robot's bodies that may touch,
    and with the path constraints of a motion as zones.
    """
    zones = tuple(map(Zone.of, keeps))
    return Cell(SourceFile("", ""), {}, {}, {}, {}, (), zones, {}, allowed=allowed)


@lru_cache(maxsize=64)
def without_parts(cell: Cell) -> Cell:
    """Return a cell without its workpieces, for use when their places aren't known. Calls with equal
    cells return the same object.
    """
    return replace(cell, parts=()) if cell.parts else cell


@lru_cache(maxsize=4096)
def _surroundings(
    cell: Cell,
    items: tuple[Item, ...],
    touches: tuple[Touch, ...],
    allowed: frozenset[tuple[str, str]],
    keeps: tuple[Keep, ...],
) -> Cell:
    bodies = tuple(body for one in items for body in bodies_of(one))
    # a part that may be at either of two places doesn't collide with itself
    twice = tuple(Touch(name, name, -np.inf) for name in doubtful(Parts(items)))
    obstacles = (*cell.obstacles, *bodies)
    touches = (*touches, *twice)
    known = cell.rules
    zones = (*cell.zones, *(Zone.of(one) for one in keeps if one not in known))
    return replace(
        cell, obstacles=obstacles, zones=zones, touches=touches, allowed=allowed, parts=(), present=None
    )


@lru_cache(maxsize=4096)
def bodies_of(item: Item) -> tuple[Obstacle, ...]:
    """Return the bodies of a workpiece or tool at its current place. The whole mass of a tool is assigned to
    its first body.
    """
    body, held = item.part.body, item.gripper is not None
    first, *more = item.solids
    own = replace(body, name=item.name, mount=Mount(constant(first[0].copy()), held), is_sure=item.is_sure)
    return own, *(
        replace(own, shape=shape, mount=Mount(constant(placed), held), mass=None, weight=None)
        for placed, shape in more
    )


@lru_cache(maxsize=1024)
def supports(robot: Robot, cell: Cell, carried: Parts, gripper: str, flange: bytes) -> tuple[Touch, ...]:
    """Find the bodies on which the workpieces of a gripper rest when the gripper takes them or puts them
    down.

    Args:
        robot: robot in the cell.
        cell: cell as in its file.
        carried: the state in which the gripper holds the workpieces.
        gripper: the variable of the gripper's output.
        flange: pose of the flange, base_from_flange (4, 4) [m], as bytes.

    Returns:
        Pairs of bodies whose distance is at most `NEAR` plus their margin; `least` is the distance [m],
        negative if they overlap. Empty without bodies that could collide.
    """
    scene = scene_of(robot, surroundings(cell, carried)).value
    names = {one.name for one in carried.held(gripper)}
    if scene is None or not names:
        return ()
    held = np.array([one.is_part and one.name in names and not one.of_cell for one in scene.bodies])
    pairs = np.flatnonzero((scene.boxes.joint[scene.pairs.first] == 0) & held[scene.pairs.second])
    first, second = scene.pairs.first[pairs], scene.pairs.second[pairs]
    moved = np.frombuffer(flange).reshape(4, 4) @ np.linalg.inv(robot.chain.base_from_flange)
    apart = scene.boxes.middle[second] @ moved[:3, :3].T + moved[:3, 3] - scene.boxes.middle[first]
    limit = scene.pairs.margin[pairs] + NEAR
    close = np.linalg.norm(apart, axis=1) - scene.boxes.bound[first] - scene.boxes.bound[second] <= limit
    pairs, first, second, apart, limit = (one[close] for one in (pairs, first, second, apart, limit))
    back = scene.boxes.rotation[first].transpose(0, 2, 1)
    seen = Relative(back @ moved[:3, :3] @ scene.boxes.rotation[second], (back @ apart[:, :, None])[:, :, 0])
    gaps = distances(scene, pairs, seen)
    return tuple(
        Touch(*scene.names(pair), float(gap))
        for pair, gap, most in zip(pairs.tolist(), gaps, limit, strict=True)
        if gap <= most
    )


def on_all_ways(ways: Iterable[tuple[Touch, ...]]) -> tuple[Touch, ...]:
    """Return the pairs of bodies that may touch on every one of several branches."""
    first, *others = [*ways] or [()]
    for other in others:
        least = {(one.part, one.other): one.least for one in other}
        first = tuple(
            replace(one, least=max(one.least, least[one.part, one.other]))
            for one in first
            if (one.part, one.other) in least
        )
    return first


def hand_is_clear(robot: Robot, cell: Cell, parts: Parts, names: tuple[str, ...], q: Array) -> bool:
    """Return True if everything on the flange keeps its distance from the given workpieces, which lie in the
    cell.

    Args:
        robot: robot in the cell.
        cell: cell as in its file.
        parts: where all workpieces are.
        names: names of the workpieces to check.
        q: joint positions (n,) [rad or m].
    """
    scene = scene_of(robot, surroundings(cell, parts)).value
    if scene is None:
        return True
    lies = np.array([one.is_part and one.name in names and one.of_cell for one in scene.bodies])
    hangs = np.array([one.joint == robot.size and one.may_hold for one in scene.bodies])
    pairs = np.flatnonzero(lies[scene.pairs.first] & hangs[scene.pairs.second])
    at = np.zeros_like(pairs)
    apart = distances(scene, pairs, relative(place(scene, q[None]), at, pairs))
    return bool((apart > scene.pairs.margin[pairs]).all())


def load_cases(robot: Robot, cell: Cell | None) -> tuple[Dynamics, ...]:
    """Return the load cases of the robot: the masses for each combination of the workpieces that it may hold.

    Args:
        robot: robot with masses.
        cell: cell at one instant.
    """
    dynamics = robot.dynamics
    if dynamics is None:
        return ()
    carried = [one for one in cell.obstacles if one.mass and one.mount.on_flange] if cell else []
    if not carried:
        return (dynamics,)
    return _load_cases(robot, dynamics, tuple(carried))


@lru_cache(maxsize=256)
def _load_cases(robot: Robot, dynamics: Dynamics, carried: tuple[Obstacle, ...]) -> tuple[Dynamics, ...]:
    sure = [one for one in carried if one.is_sure]
    for one in sure:
        dynamics = _loaded(robot, dynamics, one)
    cases = [dynamics]
    for one in carried:
        if not one.is_sure:
            cases += [_loaded(robot, each, one) for each in cases]
    return tuple(cases)


MOST_UNSURE = 5
"""Largest number of parts for which it may be unknown at one instant whether a gripper holds them. The masses
of all combinations are computed.
"""


def _loaded(robot: Robot, dynamics: Dynamics, body: Obstacle) -> Dynamics:
    placed = robot.chain.base_from_flange @ body.mount.transform
    assert body.mass is not None  # only bodies with a mass are loads
    if body.weight is None:
        center, squares = _solid(body.shape)
        inertia = np.diag(body.mass * squares)
    else:
        center, inertia = body.weight.center, body.weight.inertia
    tensor = placed[:3, :3] @ inertia @ placed[:3, :3].T
    return with_load(dynamics, body.mass, placed[:3, :3] @ center + placed[:3, 3], tensor)


def _solid(shape: Shape) -> tuple[Array, Array]:
    """Return the centre of mass of a homogeneous body in its frame (3,) [m], and the diagonal of its inertia
    about this centre divided by its mass (3,) [m^2].

    A mesh is replaced by the box around it.
    """
    center = np.zeros(3)
    match shape:
        case Box(size=size):
            return center, _of_box(size)
        case Sphere(radius=radius):
            return center, np.full(3, 0.4 * radius**2)
        case Cylinder(radius=radius, length=length):
            return center, _of_cylinder(radius, length)
        case Capsule(radius=radius, length=length):
            # use a cylinder of the capsule's full length: its inertia is an upper bound
            return center, _of_cylinder(radius, length + 2.0 * radius)
    try:
        geometry = geometry_of(shape)
    except UnreadableError:  # the collision check reports the mesh
        return center, center
    return geometry.middle, _of_box(2.0 * geometry.half)


def _of_box(size: Array) -> Array:
    squares = np.square(size)
    found: Array = (squares.sum() - squares) / 12.0
    return found


def _of_cylinder(radius: float, length: float) -> Array:
    across = radius**2 / 4.0 + length**2 / 12.0
    return np.array([across, across, radius**2 / 2.0])
