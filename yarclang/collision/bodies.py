"""Store the bodies around a robot, and the pairs of them that must not meet, as plain arrays."""

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
    """A solid body: the shape of a robot link, an obstacle, or something that the robot carries.

    `is_link`, `of_robot` and `of_cell` are all False for an obstacle that the cell mounts on the flange.

    Attributes:
        name: name of the body.
        joint: number of joints that move the body, counted from the base.
        base_from_body: (4, 4) pose of the body with all joints at zero [m].
        geometry: shape of the body.
        margin: distance that other bodies must keep from this one [m].
        is_link: True for the shape of a link.
        of_robot: True for the shape of a link, or of a tool in robot.toml.
        of_cell: True for a body that is fixed in the cell.
        is_part: True for a workpiece ("part") that grippers take, or a tool that a changer takes.
        of_tool: True only for a tool that a changer takes.
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
    of_tool: bool = False

    @property
    def may_hold(self) -> bool:
        """True for a body that may touch a workpiece ("part") while the workpiece is grasped: any body but
        another workpiece.
        """
        return not self.is_part or self.of_tool


@frozen(eq=False)
class Pairs:
    """K pairs of bodies that must not meet.

    Attributes:
        first: index of that body of each pair that fewer joints move (K,).
        second: index of the other body of each pair (K,).
        margin: the distance that the two bodies must keep from each other (K,) [m].
        touching: True if the two may touch while a workpiece is grasped or put down (K,).
        of_cell: True if one of the two is fixed in the cell (K,).
    """

    first: Rows
    second: Rows
    margin: Array
    touching: NDArray[np.bool_]
    of_cell: NDArray[np.bool_]


@frozen(eq=False)
class Boxes:
    """M bodies as arrays: a rounded box around each, the convex hull within the box, and the shape itself.

    Attributes:
        joint: the number of joints that move each body (M,).
        middle: the center of each box, with all joints at zero, in {B} (M, 3) [m].
        rotation: the orientation of each box, with all joints at zero, in {B} (M, 3, 3).
        half: half of the edges of each box (M, 3) [m].
        radius: the radius by which each box is rounded (M,) [m].
        bound: the radius of a sphere around each body (M,) [m].
        core: half of the edges of the smaller box in each hull (M, 3) [m]; see `Geometry`.
        disc: the radius of the disc in each hull (M,) [m]; see `Geometry`.
        cornered: indices of the bodies whose hull is given by corners instead of `core`, `disc` and `radius`.
        solids: the shapes themselves, as objects of the library coal or, for large meshes, as tiles.
        own_middle: the center of each box in the frame of the body's shape (M, 3) [m].
        closed: True for meshes that enclose a volume (M,).
        hollow: True for meshes that aren't their own convex hulls (M,).
    """

    joint: Rows
    middle: Array
    rotation: Array
    half: Array
    radius: Array
    bound: Array
    core: Array
    disc: Array
    cornered: tuple[int, ...]
    solids: tuple[Any, ...]
    own_middle: Array
    closed: NDArray[np.bool_]
    hollow: NDArray[np.bool_]


@frozen(eq=False)
class Scene:
    """The bodies around an arm, and those pairs of them that must not meet.

    Attributes:
        chain: the arm.
        bodies: the bodies, in any order.
        pairs: the pairs of bodies that must not meet.
        boxes: the same bodies, as arrays.
        at_home: names of the pairs of links whose shapes touch in the robot's HOME. Since the robot can be at
            HOME, these shapes must be larger than the real links, and the pairs aren't among `pairs`.
        allowed: the pairs that may touch because the program or the cell allows it; they aren't among
            `pairs`.
    """

    chain: Chain
    bodies: tuple[Body, ...]
    pairs: Pairs
    boxes: Boxes
    at_home: frozenset[tuple[str, str]]
    allowed: Pairs | None = None

    def names(self, pair: int) -> tuple[str, str]:
        """Return the names of the two bodies of a pair for messages; the body that more joints move comes
        first.
        """
        return self.bodies[self.pairs.second[pair]].name, self.bodies[self.pairs.first[pair]].name


def together(scenes: Sequence[Scene]) -> tuple[Scene, tuple[Rows, ...]]:
    """Combine several scenes of one robot into one.

    Returns:
        A scene with the bodies of all scenes, each body once; and for each scene the indices of its own
        pairs.
    """
    if len(scenes) == 1:
        return scenes[0], (np.arange(len(scenes[0].pairs.first)),)
    bodies: dict[Hashable, tuple[int, Body]] = {}
    pairs: dict[tuple[int, int, float, bool], int] = {}
    own: list[Rows] = []
    for scene in scenes:
        here = []
        for body in scene.bodies:
            # Bodies that are equal in all these properties get one common number.
            key = body.name, body.joint, body.base_from_body.tobytes(), id(body.geometry), body.margin
            here.append(bodies.setdefault(key, (len(bodies), body))[0])
        at = np.array(here, dtype=np.int64)
        columns = at[scene.pairs.first], at[scene.pairs.second], scene.pairs.margin, scene.pairs.touching
        rows = zip(*(column.tolist() for column in columns), strict=True)
        own.append(np.array([pairs.setdefault(row, len(pairs)) for row in rows], dtype=np.int64))
    first, second, limits, touching = zip(*pairs, strict=True) if pairs else ((), (), (), ())
    every = tuple(body for _, body in bodies.values())
    found = paired(
        every,
        np.array(first, dtype=np.int64),
        np.array(second, dtype=np.int64),
        np.array(limits, dtype=np.float64),
        np.array(touching, dtype=np.bool_),
    )
    return assembled(scenes[0].chain, every, found, scenes[0].at_home), tuple(own)


def paired(
    bodies: Sequence[Body], first: Rows, second: Rows, margin: Array, touching: NDArray[np.bool_]
) -> Pairs:
    """Collect pairs of bodies in `Pairs`.

    Args:
        bodies: all bodies.
        first: index of that body of each pair that fewer joints move (K,).
        second: index of the other body of each pair (K,).
        margin: the distance that the two must keep (K,) [m].
        touching: True if the two may touch (K,).
    """
    of_cell = np.array([body.of_cell for body in bodies], dtype=np.bool_)
    return Pairs(first, second, margin, touching, of_cell[first] | of_cell[second])


def assembled(
    chain: Chain, bodies: tuple[Body, ...], pairs: Pairs, at_home: frozenset[tuple[str, str]]
) -> Scene:
    """Make a scene of bodies and the pairs that must not meet.

    Args:
        chain: the arm.
        bodies: the bodies, in any order.
        pairs: the pairs of bodies that must not meet.
        at_home: names of the pairs of links that touch in HOME.
    """
    return Scene(chain, bodies, pairs, _boxes(bodies), at_home)


def _boxes(bodies: Sequence[Body]) -> Boxes:
    placed = np.array([body.base_from_body for body in bodies]).reshape(-1, 4, 4)
    middle = np.array([body.geometry.middle for body in bodies]).reshape(-1, 3)
    rotation, origin = placed[:, :3, :3], placed[:, :3, 3]
    return Boxes(
        joint=np.array([body.joint for body in bodies], dtype=np.int64),
        middle=origin + (rotation @ middle[:, :, None])[:, :, 0],
        rotation=rotation,
        half=np.array([body.geometry.half for body in bodies]).reshape(-1, 3),
        radius=np.array([body.geometry.radius for body in bodies]),
        bound=np.array([body.geometry.bound for body in bodies]),
        core=np.array([body.geometry.core for body in bodies]).reshape(-1, 3),
        disc=np.array([body.geometry.disc for body in bodies]),
        cornered=tuple(at for at, body in enumerate(bodies) if body.geometry.corners is not None),
        solids=tuple(body.geometry.solid for body in bodies),
        own_middle=middle,
        closed=np.array([body.geometry.skin is not None for body in bodies], dtype=np.bool_),
        hollow=np.array([body.geometry.is_hollow for body in bodies], dtype=np.bool_),
    )
