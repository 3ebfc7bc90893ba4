"""Convert robot, tools, parts and cell to triangles for a picture: few triangles, in the pose at the
program's start.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import Cell, HalfSpace, ShapeRegion
from yarclang.frozen import frozen
from yarclang.handling.parts import first_parts
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.report.solids import Solid, solid_of
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Robot
from yarclang.robot.placements import placements
from yarclang.robot.visuals import sticks, visual_shapes
from yarclang.shapes import Shape
from yarclang.units import MM

Kind = Literal["robot", "tool", "part", "obstacle", "zone"]

_MOST_TRIANGLES = 300
"""Largest number of triangles of a drawn body. A body with more triangles is drawn as the hull of its extreme
corners.
"""

_DIRECTIONS = 160
"""Number of directions in which the extreme corners of a body are searched to draw it as their hull."""

_PLANE = 2400.0
"""Edge length of the part of a half space's border that is drawn [mm]."""

_MOST_PIECES = 2_500
"""Largest number of triangles into which a body is divided for sorting by depth."""


@frozen(eq=False)
class Body:
    """A body that is drawn in a picture.

    Attributes:
        name: name of the link, tool, part, obstacle or zone.
        kind: kind of body.
        rule: rule of a zone; empty for other bodies.
        triangles: (F, 3, 3) corners in {B} [mm], counterclockwise seen from outside.
    """

    name: str
    kind: Kind
    rule: str
    triangles: Array


@frozen(eq=False)
class Surroundings:
    """The bodies that are drawn around a tool's path.

    Attributes:
        bodies: bodies that can be drawn.
        left_out: names of the bodies whose shapes can't be read.
    """

    bodies: tuple[Body, ...]
    left_out: tuple[str, ...]


def surroundings_of(plan: MotionPlan) -> Surroundings:
    """Return the bodies at the start of a plan's program."""
    robot, program = plan.robot, plan.program
    base_from_flange = flange_poses(robot.chain, program.start[None])[0]
    found = [*_links(robot, program.start), *_tools(robot, base_from_flange)]
    if program.cell is not None:
        found += _of_cell(program.cell, base_from_flange)
    bodies, left_out = [], []
    for name, kind, pose, shape in found:
        solid = solid_of(shape)
        if solid is None:
            left_out.append(name)
        else:
            bodies.append(Body(name, kind, "", _triangles(solid, pose)))
    zones = tuple(_zones(program.cell)) if program.cell is not None else ()
    return Surroundings((*bodies, *zones), tuple(dict.fromkeys(left_out)))


_Placed = tuple[str, Kind, Array, Shape]


def _links(robot: Robot, q: Array) -> Iterator[_Placed]:
    """Yield the robot's links with their visual shapes. If a link has no visual shape that can be read, its
    collision shapes are used. If no link has a shape, bars from joint to joint are used.
    """
    moved = _moved(robot, q)
    visuals = [(visual, solid_of(visual.shape)) for visual in visual_shapes(robot)]
    spoilt = {visual.link for visual, solid in visuals if solid is None}
    shaped = {visual.link for visual, _ in visuals} - spoilt
    for visual, _ in visuals:
        if visual.link in shaped:
            yield visual.link, "robot", moved[visual.joint] @ visual.base_from_shape, visual.shape
    if not shaped and not robot.shapes:
        for bar in sticks(robot):
            yield bar.link, "robot", moved[bar.joint] @ bar.base_from_shape, bar.shape
    for link in robot.shapes:
        if link.link not in shaped:
            yield link.link, "robot", moved[link.joint] @ link.base_from_shape, link.shape


def _moved(robot: Robot, q: Array) -> Array:
    """Return the transforms (n + 1, 4, 4) of bodies at the joint position `q`: item k moves a body that the
    first k joints carry.
    """
    chain, own = robot.chain, robot.chain.kinematics
    pose = placements(chain.screws, q[None]) if own is None else own.placements(chain, q[None])
    moved = np.tile(np.eye(4), (len(pose), 1, 1))
    moved[:, :3, :3] = pose[:, :, :3, 0]
    moved[:, :3, 3] = pose[:, :, 3, 0]
    return moved


def _tools(robot: Robot, base_from_flange: Array) -> Iterator[_Placed]:
    for tool in robot.tools:
        for part in tool.shapes if tool.mounted else ():
            yield tool.name, "tool", base_from_flange @ part.flange_from_shape, part.shape


def _of_cell(cell: Cell, base_from_flange: Array) -> Iterator[_Placed]:
    for one in cell.obstacles:
        carried = one.mount.on_flange
        pose = base_from_flange @ one.mount.transform if carried else one.mount.transform
        yield one.name, "tool" if carried else "obstacle", pose, one.shape
    for item in first_parts(cell).items:
        for pose, shape in item.solids:
            yield item.name, "part", base_from_flange @ pose if item.gripper is not None else pose, shape


def _zones(cell: Cell) -> Iterator[Body]:
    for zone in cell.zones:
        match zone.region:
            case ShapeRegion(base_from_shape=pose, shape=shape):
                if (solid := solid_of(shape)) is not None:
                    yield Body(zone.name, "zone", zone.rule, _triangles(solid, pose))
            case HalfSpace(base_from_plane=pose):
                half = _PLANE * MM / 2.0
                corners = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
                plane = Solid(corners, np.array([[0, 1, 2], [0, 2, 3]]))
                yield Body(zone.name, "zone", zone.rule, _triangles(plane, pose))
            case _:  # a zone that only limits the joints has no shape
                pass


def _triangles(solid: Solid, pose: Array) -> Array:
    vertices, faces = solid.vertices, solid.faces
    if len(faces) > _MOST_TRIANGLES:
        vertices, faces = _outline(vertices)
    placed = (vertices @ pose[:3, :3].T + pose[:3, 3]) / MM
    triangles: Array = placed[faces]
    return triangles


def _outline(vertices: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return corners and faces of a simplified body: the hull of its extreme corners in `_DIRECTIONS`
    directions. If these corners are in one plane, return the box around them.
    """
    from scipy.spatial import ConvexHull, QhullError

    turns = np.pi * (1.0 + 5.0**0.5) * np.arange(_DIRECTIONS)
    height = 1.0 - 2.0 * (np.arange(_DIRECTIONS) + 0.5) / _DIRECTIONS
    out = np.sqrt(1.0 - height**2)
    directions = np.column_stack((out * np.cos(turns), out * np.sin(turns), height))
    corners = vertices[np.unique(np.argmax(vertices @ directions.T, axis=0))]
    try:
        hull = ConvexHull(corners)
    except (QhullError, ValueError):
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        corners = np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1).reshape(-1, 3)
        quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        return corners, np.array([[q[0], *pair] for q in quads for pair in (q[1:3], q[2:4])])
    faces: NDArray[np.int64] = hull.simplices.astype(np.int64)
    a, b, c = corners[faces].transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return corners, faces


def within(triangles: Array, low: Array, high: Array, longest: float) -> Array:
    """Cut the triangles of a body at a box. Return those inside it, small enough to be sorted by depth.

    Args:
        triangles: (F, 3, 3) [mm].
        low: (3,) smallest coordinates of the box [mm].
        high: (3,) largest coordinates of the box [mm].
        longest: longest edge of a triangle [mm]; longer edges are allowed if there would be too many
            triangles.
    """
    pieces: list[Array] = []
    large = triangles
    while len(large):
        inside = (large.max(axis=1) >= low).all(axis=1) & (large.min(axis=1) <= high).all(axis=1)
        large = large[inside]
        edges = np.linalg.norm(large - np.roll(large, 1, axis=1), axis=2)
        is_small = edges.max(axis=1, initial=0.0) <= longest
        if 4 * int((~is_small).sum()) + sum(map(len, pieces)) > _MOST_PIECES:
            pieces.append(large)
            break
        pieces.append(large[is_small])
        large = _split(large[~is_small])
    found: Array = np.concatenate(pieces) if pieces else triangles[:0]
    for axis in range(3):
        found = _cut(_cut(found, axis, -1.0, low[axis]), axis, 1.0, high[axis])
    return found


def _cut(triangles: Array, axis: int, sign: float, bound: float) -> Array:
    """Cut triangles (F, 3, 3) at a plane, and return those on one side: where `sign` times the coordinate is
    no larger than `sign` times `bound`.
    """
    beyond = sign * (triangles[:, :, axis] - bound)
    outside = beyond > 0.0
    count = outside.sum(axis=1)
    # rotate the corners of each triangle that the plane cuts: the corner that is alone on its side of the
    # plane comes first
    single = np.where(count == 1, outside.argmax(axis=1), (~outside).argmax(axis=1))
    order = (np.arange(3) + single[:, None]) % 3
    rows = np.arange(len(triangles))[:, None]
    a, b, c = triangles[rows, order].transpose(1, 0, 2)
    at_a, at_b, at_c = beyond[rows, order].T
    kept_triangles = [triangles[count == 0]]
    for number in (1, 2):
        chosen = count == number
        to_b = (at_a[chosen] / (at_a[chosen] - at_b[chosen]))[:, None]
        to_c = (at_a[chosen] / (at_a[chosen] - at_c[chosen]))[:, None]
        on_b = a[chosen] + to_b * (b[chosen] - a[chosen])
        on_c = a[chosen] + to_c * (c[chosen] - a[chosen])
        if number == 2:  # the single corner is kept
            kept_triangles.append(np.stack((a[chosen], on_b, on_c), axis=1))
        else:
            kept_triangles += [
                np.stack((on_b, b[chosen], c[chosen]), axis=1),
                np.stack((on_b, c[chosen], on_c), axis=1),
            ]
    found: Array = np.concatenate(kept_triangles)
    return found


def _split(triangles: Array) -> Array:
    """Divide each triangle at the middle of its longest edge."""
    a, b, c = triangles.transpose(1, 0, 2)
    size = np.linalg.norm(np.stack((b - a, c - b, a - c)), axis=2).argmax(axis=0)
    turned = triangles[np.arange(len(triangles))[:, None], (np.arange(3) + size[:, None]) % 3]
    a, b, c = turned.transpose(1, 0, 2)
    middle = (a + b) / 2.0
    parts: Array = np.concatenate((np.stack((a, middle, c), axis=1), np.stack((middle, b, c), axis=1)))
    return parts


def box_of(bodies: Iterable[Body]) -> tuple[Array, Array]:
    """Return the smallest and largest coordinates (3,) of the box around bodies [mm]; infinite if there
    are none.
    """
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for body in bodies:
        low = np.minimum(low, body.triangles.min(axis=(0, 1)))
        high = np.maximum(high, body.triangles.max(axis=(0, 1)))
    return low, high
