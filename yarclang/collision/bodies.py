"""Bodies around a robot with the pairs of them that must not meet, as plain arrays."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.geometry import Geometry
from yarclang.frozen import frozen
from yarclang.robot.model import Chain
from yarclang.shapes import Array

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
    found = PairRows(
        np.array(first, dtype=np.int64),
        np.array(second, dtype=np.int64),
        np.array(limits, dtype=np.float64),
        np.array(touching, dtype=np.bool_),
    )
    every = tuple(body for _, body in bodies.values())
    return assembled(scenes[0].chain, every, found, scenes[0].at_home), tuple(own)


@frozen(eq=False)
class PairRows:
    """K pairs, as `Scene` has them."""

    first: Rows
    second: Rows
    margin: Array
    touching: NDArray[np.bool_]


def assembled(
    chain: Chain, bodies: tuple[Body, ...], pairs: PairRows, at_home: frozenset[tuple[str, str]]
) -> Scene:
    """Return the scene of bodies and their pairs.

    Args:
        chain: the arm.
        bodies: in any order.
        pairs: of these bodies.
        at_home: names of the links that touch in HOME.
    """
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
