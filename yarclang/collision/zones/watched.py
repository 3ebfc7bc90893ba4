"""Make the items that zones watch: bodies of the arm and its tools, and points."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from yarclang.cell.keeping import Height
from yarclang.cell.model import Cell, Zone
from yarclang.collision.scene import Body, Scene, scene_of
from yarclang.frozen import frozen
from yarclang.robot.kinematics.elbow import elbow_of
from yarclang.robot.model import Chain, Robot
from yarclang.shapes import Array
from yarclang.transforms import constant


@frozen(eq=False)
class Moving:
    """The frame that a motion moves.

    Attributes:
        name: name of the frame without braces.
        flange_from_moving: (4, 4) pose of the frame on the flange [m].
    """

    name: str
    flange_from_moving: Array


@frozen(eq=False)
class Item:
    """A convex body, or a point, that a zone watches.

    The item is the Minkowski sum of the hull of `points`, a disc and a ball of `radius`. All coordinates are
    in {B} with all joints at zero [m].

    Attributes:
        name: name of the body or point.
        joint: number of joints that move the item, counted from the base.
        points: (V, 3) points whose hull is the core of the item.
        axis: (3,) axis perpendicular to the disc.
        disc: radius of the disc.
        radius: radius of the ball.
        rim: (W, 3) points whose hull encloses the sum of core and disc. For them, the disc is replaced by a
            polygon around it, half a percent larger.
        middle: (3,) center of a ball around the whole item.
        bound: radius of this ball.
        of_coal: the shape in the library coal; None for a point.
        base_from_body: (4, 4) pose of this shape; None for a point.
    """

    name: str
    joint: int
    points: Array
    axis: Array
    disc: float
    radius: float
    rim: Array
    middle: Array
    bound: float
    of_coal: Any = None
    base_from_body: Array | None = None


def items_of(robot: Robot, cell: Cell, zone: Zone, moving: Moving) -> tuple[Item, ...]:
    """Return the bodies and points that a zone of a cell watches while a frame is moved.

    The result is empty if meshes can't be read, which is reported elsewhere.

    Args:
        robot: the robot.
        cell: the cell of the robot.
        zone: a zone of the cell.
        moving: the frame that is moved.
    """
    made = scene_of(robot, cell)
    if made.value is None:
        return ()
    if zone.keep is not None:
        assert isinstance(zone.keep.region, Height)  # the other rules watch no bodies
        own = np.eye(4)
        own[:3, 3] = zone.keep.region.own
        return (point_of(robot, Moving(zone.keep.frame, own)),)
    found: dict[str, Item] = {}
    for part in zone.watch:
        for item in _of_part(robot, made.value, part, moving):
            found.setdefault(f"{item.name} {item.points.tobytes().hex()}", item)
    return tuple(found.values())


def tool_frame(robot: Robot) -> Moving:
    """Return the frame that is moved if a motion names none: {TCP}, or {FLANGE} if there is no {TCP}."""
    name = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
    return Moving(name, robot.flange_from_frame.get(name, constant(np.eye(4))))


def _of_part(robot: Robot, scene: Scene, part: str, moving: Moving) -> Iterator[Item]:
    bodies = bodies_of(scene)
    match part:
        case "tcp" | "tool":
            yield point_of(robot, moving)
            if part == "tool":
                yield from (item for body, item in bodies if not body.is_link and not body.of_cell)
        case "elbow":
            elbow = _elbow(robot.chain)
            if elbow is not None:
                yield point_item("the elbow", *elbow)
        case "arm":
            yield from (item for body, item in bodies if body.is_link and body.joint)
        case _:
            yield from (item for body, item in bodies if body.is_link and body.name == part)


def point_of(robot: Robot, moving: Moving) -> Item:
    """Return the origin of a moved frame as an item that zones can watch."""
    placed = robot.chain.base_from_flange @ moving.flange_from_moving
    return point_item(f"{{{moving.name}}}", robot.size, placed[:3, 3])


def _elbow(chain: Chain) -> tuple[int, Array] | None:
    """Return the number of joints that move the arm's elbow, and the elbow's position (3,) in {B} with all
    joints at zero; None if the arm has no elbow.
    """
    if chain.kinematics is not None:
        return chain.kinematics.elbow(chain)
    found = elbow_of(chain)
    return None if found is None else (found.joint, found.point)


@lru_cache(maxsize=32)
def bodies_of(scene: Scene) -> tuple[tuple[Body, Item], ...]:
    """Return all bodies of a scene, each as an item that zones can watch; cached by the scene's identity."""
    return tuple((body, room_of(body)) for body in scene.bodies)


def point_item(name: str, joint: int, point: Array) -> Item:
    """Return a point (3,) as an item that zones can watch.

    The point is in {B} with all joints at zero [m], and the first `joint` joints move it.
    """
    points = constant(point[None].copy())
    return Item(name, joint, points, constant(np.zeros(3)), 0.0, 0.0, points, points[0], 0.0)


_SIDES = 32
"""Number of sides of the polygon around a disc."""


@lru_cache(maxsize=1024)
def room_of(body: Body) -> Item:
    """Return a body as an item that zones can watch, cached by the body's identity."""
    import coal

    shape, placed = body.geometry.of_coal, body.base_from_body
    disc = radius = 0.0
    match shape:
        case coal.Box():
            points = _corners(np.array(shape.halfSide))
        case coal.Sphere():
            points, radius = np.zeros((1, 3)), float(shape.radius)
        case coal.Capsule():
            points, radius = _stick(shape.halfLength), float(shape.radius)
        case coal.Cylinder():
            points, disc = _stick(shape.halfLength), float(shape.radius)
        case coal.ConvexBase():
            points = np.array(shape.points())
        case _:  # a mesh counts as its hull, which is never smaller
            points = np.array(shape.vertices())
            if np.linalg.matrix_rank(points - points.mean(axis=0), tol=_FLAT) == 3:
                shape.buildConvexHull(True, "Qt")
                shape = shape.convex
                points = np.array(shape.points())
    rim = points
    if disc:
        turns = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
        # A polygon around a circle of radius 1 has corners at the distance 1 / cos(pi / sides).
        polygon = np.stack([np.cos(turns), np.sin(turns), np.zeros(_SIDES)], axis=1)
        rim = (points[:, None] + polygon * (disc / np.cos(np.pi / _SIDES))).reshape(-1, 3)
    turn, shift = placed[:3, :3], placed[:3, 3]
    # Enclose the points, the disc and the rounding in a ball.
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    bound = float(np.hypot(np.linalg.norm(points - middle, axis=1).max(), disc)) + radius
    return Item(
        body.name,
        body.joint,
        constant(points @ turn.T + shift),
        constant(turn[:, 2].copy()),
        disc,
        radius,
        constant(rim @ turn.T + shift),
        constant(turn @ middle + shift),
        bound,
        shape,
        placed,
    )


_FLAT = 1e-6
"""Thickness below which coal can't make a hull of a mesh [m]."""


def _corners(half: Array) -> Array:
    signs = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    corners: Array = signs * half
    return corners


def _stick(half: float) -> Array:
    return np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
