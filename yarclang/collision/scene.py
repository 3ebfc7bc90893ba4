"""All bodies around a robot, and the pairs of them that must not meet."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import Cell, Obstacle
from yarclang.collision.geometry import Geometry, UnreadableError, geometry_of
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.robot.model import Chain, Robot
from yarclang.shapes import Array, Mesh, Shape

Rows = NDArray[np.int64]


@frozen(eq=False)
class Body:
    """Something that has room: a link's shape, an obstacle, or what the robot carries.

    `joint` is how many joints move it, those from the base on. `base_from_body` (4, 4) [m] is where it is with all joints at zero.
    `margin` [m] is how far other bodies stay away from it. `is_link` says that it is a link's shape, `of_robot` that it is a link's or that of a
    tool of robot.toml, `of_cell` that it stands in the cell: what the cell says that the robot carries is none of these.
    """

    name: str
    joint: int
    base_from_body: Array
    geometry: Geometry
    margin: float
    is_link: bool
    of_robot: bool
    of_cell: bool


@frozen(eq=False)
class Scene:
    """The bodies, and for K pairs of them: `first` and `second` (K,), of which `second` is moved by more joints, `margin` (K,) [m], and whether
    one of both stands in the cell (`of_cell`). `at_home` are the pairs of links that touch in the robot's HOME: there it stands, so that it is their
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


@lru_cache(maxsize=32)
def scene_of(robot: Robot, cell: Cell | None, *, lenient: bool = True) -> Result[Scene]:
    """The robot's links and tools and what the cell adds, remembered by identity; None with findings about meshes that can't be read.

    If it isn't `lenient`, links that touch in HOME are among the pairs as well.
    """
    findings: list[Diagnostic] = []
    bodies: list[Body] = []

    def add(
        name: str,
        joint: int,
        placed: Array,
        shape: Shape,
        obstacle: Obstacle | None = None,
        *,
        is_link: bool = False,
    ) -> None:
        try:
            geometry = geometry_of(shape, hull=obstacle is None)
        except UnreadableError as error:
            assert isinstance(shape, Mesh)  # only a mesh has a file
            source = cell.source if obstacle and cell else None
            message = f"the mesh {shape.path.name} of {name} {error}"
            findings.append(Diagnostic("Y0904", message, source, None, _MESH))
        else:
            margin = obstacle.margin if obstacle else 0.0
            stands = obstacle is not None and not obstacle.mount.on_flange
            bodies.append(Body(name, joint, placed, geometry, margin, is_link, obstacle is None, stands))

    for link in robot.shapes:
        add(link.link, link.joint, link.base_from_shape, link.shape, is_link=True)
    for tool in robot.tools:
        for part in tool.shapes if tool.mounted else ():
            add(tool.name, robot.size, robot.chain.base_from_flange @ part.flange_from_shape, part.shape)
    for one in cell.obstacles if cell else ():
        carried = one.mount.on_flange
        placed = robot.chain.base_from_flange @ one.mount.transform if carried else one.mount.transform
        add(one.name, robot.size if carried else 0, placed, one.shape, one)
    if findings:
        return Result(None, tuple(findings))
    return Result(_scene(robot, tuple(bodies), lenient=lenient))


_MESH = "save it again as a binary STL, and check that it isn't empty"


def _scene(robot: Robot, bodies: tuple[Body, ...], *, lenient: bool) -> Scene:
    whole = _with_pairs(robot, bodies, _pairs(robot, bodies), frozenset())
    links = [body.is_link for body in bodies]
    own = np.array(
        [pair for pair, one in enumerate(whole.first) if links[one] and links[whole.second[pair]]],
        dtype=np.int64,
    )
    if not len(own) or not lenient:
        return whole
    from yarclang.collision.placing import distances, place, relative

    apart = distances(whole, own, relative(place(whole, robot.home[None]), np.zeros_like(own), own))
    touching = frozenset(whole.names(int(pair)) for pair in own[apart <= TOUCHING])
    kept = [
        (int(one), int(other))
        for pair, (one, other) in enumerate(zip(whole.first, whole.second, strict=True))
        if not (links[one] and links[other] and whole.names(pair) in touching)
    ]
    return _with_pairs(robot, bodies, kept, touching) if touching else whole


TOUCHING = 2e-5
"""Links nearer than this [m] touch."""


def _with_pairs(
    robot: Robot, bodies: tuple[Body, ...], chosen: list[tuple[int, int]], at_home: frozenset[tuple[str, str]]
) -> Scene:
    pairs = [_ordered(bodies, one, other) for one, other in chosen]
    first, second = (np.array([pair[side] for pair in pairs], dtype=np.int64) for side in (0, 1))
    placed = np.array([body.base_from_body for body in bodies]).reshape(-1, 4, 4)
    middle = np.array([body.geometry.middle for body in bodies]).reshape(-1, 3)
    margin = np.array([body.margin for body in bodies])
    of_cell = np.array([body.of_cell for body in bodies], dtype=np.bool_)
    rotation, origin = placed[:, :3, :3], placed[:, :3, 3]
    return Scene(
        robot.chain,
        bodies,
        first,
        second,
        np.maximum(margin[first], margin[second]),
        of_cell[first] | of_cell[second],
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


def _pairs(robot: Robot, bodies: tuple[Body, ...]) -> list[tuple[int, int]]:
    """The pairs that must not meet.

    Not those that never move against each other, nor neighbouring links, which meet in the joint between them, nor
    those that robot.toml allows.
    """
    shaped = sorted({body.joint for body in bodies if body.is_link})
    neighbours = set(pairwise(shaped))
    found = []
    for one, body in enumerate(bodies):
        for other in range(one):
            joints = sorted((body.joint, bodies[other].joint))
            if joints[0] == joints[1]:
                continue
            if body.is_link and bodies[other].is_link and (joints[0], joints[1]) in neighbours:
                continue
            if body.of_robot and bodies[other].of_robot:
                first, second = sorted((body.name, bodies[other].name))
                if (first, second) in robot.allowed:
                    continue
            found.append((other, one))
    return found


def _ordered(bodies: tuple[Body, ...], one: int, other: int) -> tuple[int, int]:
    """The body that fewer joints move first."""
    return (one, other) if bodies[one].joint <= bodies[other].joint else (other, one)
