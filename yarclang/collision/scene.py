"""All bodies around a robot, and the pairs of them that must not meet."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import Cell, Touch
from yarclang.collision.geometry import Geometry, UnreadableError, geometry_of
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.robot.model import Chain, Robot
from yarclang.shapes import Array, Mesh, Shape
from yarclang.source import SourceFile

Rows = NDArray[np.int64]


@frozen(eq=False)
class Body:
    """Something that has room: a link's shape, an obstacle, or what the robot carries.

    `joint` is how many joints move it, those from the base on. `base_from_body` (4, 4) [m] is where it is with all joints at zero.
    `margin` [m] is how far other bodies stay away from it. `is_link` says that it is a link's shape, `of_robot` that it is a link's or that of a
    tool of robot.toml, `of_cell` that it stands in the cell: what the cell says that the robot carries is none of these. `is_part` is True for what grippers take.
    """

    name: str
    joint: int
    base_from_body: Array
    geometry: Geometry
    margin: float
    is_link: bool
    of_robot: bool
    of_cell: bool
    is_part: bool = False


@frozen(eq=False)
class Scene:
    """The bodies, and for K pairs of them: `first` and `second` (K,), of which `second` is moved by more joints, `margin` (K,) [m], whether
    one of both stands in the cell (`of_cell`), and whether they may touch as a part is taken or put down (`touching`). `at_home` are the pairs of links that touch in the robot's HOME: there it stands, so that it is their
    shapes that are too large, and they aren't among the pairs.

    Per body: `joint` (M,), `middle` (M, 3) of its box, `rotation` (M, 3, 3) with all joints at zero, in {B}; `half` (M, 3), `radius` and
    `bound` (M,) of its box; `core` (M, 3) and `disc` (M,) of its hull; `cornered` are the bodies whose hull has corners instead.
    `of_coal` are the shapes themselves, `own_middle` (M, 3) is the middle of the box in the shape's frame, `closed` (M,) are the meshes that enclose a room.
    """

    chain: Chain
    bodies: tuple[Body, ...]
    first: Rows
    second: Rows
    margin: Array
    of_cell: NDArray[np.bool_]
    touching: NDArray[np.bool_]
    at_home: frozenset[tuple[str, str]]
    joint: Rows
    middle: Array
    rotation: Array
    half: Array
    radius: Array
    bound: Array
    core: Array
    disc: Array
    cornered: tuple[int, ...]
    of_coal: tuple[Any, ...]
    own_middle: Array
    closed: NDArray[np.bool_]

    def names(self, pair: int) -> tuple[str, str]:
        """How messages call the two bodies of a pair, the one that moves more first."""
        return self.bodies[self.second[pair]].name, self.bodies[self.first[pair]].name


@lru_cache(maxsize=256)
def scene_of(robot: Robot, cell: Cell | None, *, lenient: bool = True) -> Result[Scene]:
    """The robot's links and tools and what the cell adds, remembered by identity; None with findings about meshes that can't be read.

    If it isn't `lenient`, links that touch in HOME are among the pairs as well.
    """
    own = _of_robot(robot)
    findings = list(own.diagnostics)
    bodies = list(own.value or ())
    for one in cell.obstacles if cell else ():
        carried = one.mount.on_flange
        placed = robot.chain.base_from_flange @ one.mount.transform if carried else one.mount.transform
        geometry = _geometry(one.shape, False)
        if isinstance(geometry, str):
            findings.append(_unreadable(one.name, one.shape, geometry, cell.source if cell else None))
        else:
            joint = robot.size if carried else 0
            bodies.append(
                Body(
                    one.name,
                    joint,
                    placed,
                    geometry,
                    one.margin,
                    is_link=False,
                    of_robot=False,
                    of_cell=not carried,
                    is_part=one.is_part,
                )
            )
    if findings:
        return Result(None, tuple(findings))
    at_home = _touching_at_home(robot) if lenient else frozenset()
    touches = cell.touches if cell else ()
    return Result(_scene(robot, tuple(bodies), touches, at_home))


@lru_cache(maxsize=32)
def _of_robot(robot: Robot) -> Result[tuple[Body, ...]]:
    """Return the bodies of a robot's links and mounted tools."""
    parts = [(link.link, link.joint, link.base_from_shape, link.shape, True) for link in robot.shapes]
    for tool in robot.tools:
        parts += [
            (tool.name, robot.size, robot.chain.base_from_flange @ part.flange_from_shape, part.shape, False)
            for part in (tool.shapes if tool.mounted else ())
        ]
    findings: list[Diagnostic] = []
    bodies: list[Body] = []
    for name, joint, placed, shape, is_link in parts:
        geometry = _geometry(shape, True)
        if isinstance(geometry, str):
            findings.append(_unreadable(name, shape, geometry, None))
        else:
            bodies.append(Body(name, joint, placed, geometry, 0.0, is_link, of_robot=True, of_cell=False))
    return Result(tuple(bodies), tuple(findings))


@lru_cache(maxsize=1024)
def _geometry(shape: Shape, hull: bool) -> Geometry | str:
    """Return a shape for distances, or what is wrong with its mesh."""
    try:
        return geometry_of(shape, hull=hull)
    except UnreadableError as error:
        return str(error)


def _unreadable(name: str, shape: Shape, reason: str, source: SourceFile | None) -> Diagnostic:
    assert isinstance(shape, Mesh)  # only a mesh has a file
    return Diagnostic("Y0904", f"the mesh {shape.path.name} of {name} {reason}", source, None, _MESH)


_MESH = "save it again as a binary STL, and check that it isn't empty"


@lru_cache(maxsize=32)
def _touching_at_home(robot: Robot) -> frozenset[tuple[str, str]]:
    """Return the pairs of links that touch in the robot's HOME, as `Scene.names` has them."""
    from yarclang.collision.placing import distances, place, relative

    links = tuple(body for body in _of_robot(robot).value or () if body.is_link)
    scene = _scene(robot, links, (), frozenset())
    pairs = np.arange(len(scene.first))
    if not len(pairs):
        return frozenset()
    apart = distances(scene, pairs, relative(place(scene, robot.home[None]), np.zeros_like(pairs), pairs))
    return frozenset(scene.names(int(pair)) for pair in pairs[apart <= TOUCHING])


def _scene(
    robot: Robot,
    bodies: tuple[Body, ...],
    touches: tuple[Touch, ...],
    at_home: frozenset[tuple[str, str]],
) -> Scene:
    pairs = [_ordered(bodies, one, other) for one, other in _pairs(robot, bodies)]
    if at_home:
        pairs = [
            (one, other)
            for one, other in pairs
            if not (bodies[one].is_link and bodies[other].is_link)
            or (bodies[other].name, bodies[one].name) not in at_home
        ]
    margin = np.array([body.margin for body in bodies])
    first, second = (np.array([pair[side] for pair in pairs], dtype=np.int64) for side in (0, 1))
    limits = np.maximum(margin[first], margin[second])
    least = _least(robot, bodies, pairs, touches) if touches else np.full(len(pairs), np.inf)
    kept = np.flatnonzero(least > -np.inf)
    rows = _PairRows(first[kept], second[kept], np.minimum(limits, least)[kept], (least < limits)[kept])
    return _assembled(robot.chain, bodies, rows, at_home)


def together(scenes: Sequence[Scene]) -> tuple[Scene, tuple[Rows, ...]]:
    """Put several scenes of one robot into one.

    Returns:
        A scene with the bodies of all, each of them once, and for each scene the pairs that are its own.
    """
    if len(scenes) == 1:
        return scenes[0], (np.arange(len(scenes[0].first)),)
    bodies: dict[Hashable, tuple[int, Body]] = {}
    pairs: dict[tuple[int, int, float, bool], int] = {}
    own: list[Rows] = []
    for scene in scenes:
        here = []
        for body in scene.bodies:
            key = body.name, body.joint, body.base_from_body.tobytes(), id(body.geometry), body.margin
            here.append(bodies.setdefault(key, (len(bodies), body))[0])
        at = np.array(here, dtype=np.int64)
        columns = at[scene.first], at[scene.second], scene.margin, scene.touching
        rows = zip(*(column.tolist() for column in columns), strict=True)
        own.append(np.array([pairs.setdefault(row, len(pairs)) for row in rows], dtype=np.int64))
    first, second, limits, touching = zip(*pairs, strict=True) if pairs else ((), (), (), ())
    found = _PairRows(
        np.array(first, dtype=np.int64),
        np.array(second, dtype=np.int64),
        np.array(limits, dtype=np.float64),
        np.array(touching, dtype=np.bool_),
    )
    every = tuple(body for _, body in bodies.values())
    return _assembled(scenes[0].chain, every, found, scenes[0].at_home), tuple(own)


TOUCHING = 2e-5
"""Links nearer than this [m] touch."""


@frozen(eq=False)
class _PairRows:
    """K pairs, as `Scene` has them."""

    first: Rows
    second: Rows
    margin: Array
    touching: NDArray[np.bool_]


def _assembled(
    chain: Chain, bodies: tuple[Body, ...], pairs: _PairRows, at_home: frozenset[tuple[str, str]]
) -> Scene:
    first, second = pairs.first, pairs.second
    placed = np.array([body.base_from_body for body in bodies]).reshape(-1, 4, 4)
    middle = np.array([body.geometry.middle for body in bodies]).reshape(-1, 3)
    of_cell = np.array([body.of_cell for body in bodies], dtype=np.bool_)
    rotation, origin = placed[:, :3, :3], placed[:, :3, 3]
    return Scene(
        chain,
        bodies,
        first,
        second,
        pairs.margin,
        of_cell[first] | of_cell[second],
        pairs.touching,
        at_home,
        np.array([body.joint for body in bodies], dtype=np.int64),
        origin + (rotation @ middle[:, :, None])[:, :, 0],
        rotation,
        np.array([body.geometry.half for body in bodies]).reshape(-1, 3),
        np.array([body.geometry.radius for body in bodies]),
        np.array([body.geometry.bound for body in bodies]),
        np.array([body.geometry.core for body in bodies]).reshape(-1, 3),
        np.array([body.geometry.disc for body in bodies]),
        tuple(at for at, body in enumerate(bodies) if body.geometry.corners is not None),
        tuple(body.geometry.of_coal for body in bodies),
        np.array([body.geometry.middle for body in bodies]).reshape(-1, 3),
        np.array([body.geometry.skin is not None for body in bodies], dtype=np.bool_),
    )


def _least(
    robot: Robot, bodies: tuple[Body, ...], pairs: list[tuple[int, int]], touches: tuple[Touch, ...]
) -> Array:
    """Return how near the pairs may come where that is less than their margins, (K,) [m]; infinite for all others."""
    named: dict[tuple[str, str | None], float] = {}
    for one in touches:
        key = one.part, one.other
        named[key] = min(named.get(key, np.inf), one.least)
    found = []
    for first, second in pairs:
        least = np.inf
        for part, other in ((bodies[first], bodies[second]), (bodies[second], bodies[first])):
            if part.is_part:
                least = min(least, named.get((part.name, other.name), np.inf))
                if other.joint == robot.size and not other.is_part:
                    least = min(least, named.get((part.name, None), np.inf))
        found.append(least)
    return np.array(found)


def _pairs(robot: Robot, bodies: tuple[Body, ...]) -> list[tuple[int, int]]:
    """The pairs that must not meet.

    Not those that never move against each other, nor neighbouring links, which meet in the joint between them, nor
    those that robot.toml allows.
    """
    shaped = sorted({body.joint for body in bodies if body.is_link})
    neighbours = set(pairwise(shaped))
    joint = np.array([body.joint for body in bodies])
    found = []
    # many bodies stand still: they are no pairs among themselves
    for one, other in zip(*np.nonzero(np.tril(joint[:, None] != joint[None])), strict=True):
        body, neighbour = bodies[one], bodies[other]
        joints = sorted((body.joint, neighbour.joint))
        if body.is_link and neighbour.is_link and (joints[0], joints[1]) in neighbours:
            continue
        if body.of_robot and neighbour.of_robot:
            first, second = sorted((body.name, neighbour.name))
            if (first, second) in robot.allowed:
                continue
        found.append((int(other), int(one)))
    return found


def _ordered(bodies: tuple[Body, ...], one: int, other: int) -> tuple[int, int]:
    """The body that fewer joints move first."""
    return (one, other) if bodies[one].joint <= bodies[other].joint else (other, one)
