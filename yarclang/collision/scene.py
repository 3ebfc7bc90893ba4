"""Collect all bodies around a robot, and the pairs of them that must not meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from yarclang.cell.model import Cell, Touch
from yarclang.collision.bodies import Body, Pairs, Rows, Scene, assembled, paired, together
from yarclang.collision.geometry import Geometry, UnreadableError, geometry_of
from yarclang.collision.pieces import OpenMeshError, pieces_of_mesh
from yarclang.collision.placing import distances, place, relative
from yarclang.diagnostics import Diagnostic, Result
from yarclang.robot.model import Robot
from yarclang.shapes import Array, Mesh, Shape
from yarclang.source import SourceFile

__all__ = ["TOUCHING", "Body", "Rows", "Scene", "allowed_name", "geometries", "scene_of", "together"]

TOUCHING = 2e-5
"""Distance below which links count as touching [m]."""


@lru_cache(maxsize=256)
def scene_of(robot: Robot, cell: Cell | None, *, lenient: bool = True) -> Result[Scene]:
    """Return the scene of a robot's links and tools and the bodies of its cell, cached by identity.

    The result is None, with findings, if meshes can't be read.

    Args:
        robot: the robot with its links and tools.
        cell: the cell with its obstacles and workpieces, or None.
        lenient: False to keep links that touch in HOME among the pairs.
    """
    own = _of_robot(robot)
    findings = list(own.diagnostics)
    bodies = list(own.value or ())
    for one in cell.obstacles if cell else ():
        carried = one.mount.on_flange
        placed = robot.chain.base_from_flange @ one.mount.transform if carried else one.mount.transform
        made = geometries(one.shape, False)
        if isinstance(made, UnreadableError):
            findings.append(_unreadable(one.name, one.shape, made, cell.source if cell else None))
            continue
        joint = robot.size if carried else 0
        bodies += [
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
                of_tool=one.of_tool,
            )
            for geometry in made
        ]
    if findings:
        return Result(None, tuple(findings))
    at_home = _touching_at_home(robot) if lenient else frozenset()
    touches, allowed = (cell.touches, cell.allowed) if cell else ((), frozenset[tuple[str, str]]())
    return Result(_scene(robot, tuple(bodies), touches, at_home, allowed))


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
        made = geometries(shape, True)
        if isinstance(made, UnreadableError):
            findings.append(_unreadable(name, shape, made, None))
            continue
        bodies += [
            Body(name, joint, placed, geometry, 0.0, is_link, of_robot=True, of_cell=False)
            for geometry in made
        ]
    return Result(tuple(bodies), tuple(findings))


@lru_cache(maxsize=1024)
def geometries(shape: Shape, hull: bool) -> tuple[Geometry, ...] | UnreadableError:
    """Convert a shape for the computation of distances, into convex pieces if some are requested; if its mesh
    is faulty, return the error.
    """
    try:
        if isinstance(shape, Mesh) and shape.pieces:
            return pieces_of_mesh(shape)
        return (geometry_of(shape, hull=hull),)
    except UnreadableError as error:
        return error


def _unreadable(name: str, shape: Shape, fault: UnreadableError, source: SourceFile | None) -> Diagnostic:
    assert isinstance(shape, Mesh)  # only a mesh has a file
    mesh = f"the mesh {shape.path.name} of {name}"
    if isinstance(fault, OpenMeshError):
        message = f"{mesh} isn't closed, so it can't be divided into {shape.pieces} pieces"
        return Diagnostic("Y0960", message, source, None, _OPEN)
    return Diagnostic("Y0904", f"{mesh} {fault}", source, None, _MESH)


_OPEN = "close its holes and save it again, or remove pieces"
_MESH = "save it again as a binary STL, and check that it isn't empty"


@lru_cache(maxsize=32)
def _touching_at_home(robot: Robot) -> frozenset[tuple[str, str]]:
    """Return the names of the pairs of links that touch in the robot's HOME, as in `Scene.names`."""
    links = tuple(body for body in _of_robot(robot).value or () if body.is_link)
    scene = _scene(robot, links, (), frozenset())
    pairs = np.arange(len(scene.pairs.first))
    if not len(pairs):
        return frozenset()
    apart = distances(scene, pairs, relative(place(scene, robot.home[None]), np.zeros_like(pairs), pairs))
    return frozenset(scene.names(int(pair)) for pair in pairs[apart <= TOUCHING])


def _scene(
    robot: Robot,
    bodies: tuple[Body, ...],
    touches: tuple[Touch, ...],
    at_home: frozenset[tuple[str, str]],
    allowed: frozenset[tuple[str, str]] = frozenset(),
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
    # The larger margin of both bodies counts, unless an exception allows less.
    limits = np.maximum(margin[first], margin[second])
    least = _least(robot, bodies, pairs, touches) if touches else np.full(len(pairs), np.inf)
    may = (
        np.array([allowed_name(bodies, pair) in allowed for pair in pairs], dtype=np.bool_)
        if allowed
        else None
    )

    def chosen(rows: Rows) -> Pairs:
        return paired(
            bodies, first[rows], second[rows], np.minimum(limits, least)[rows], (least < limits)[rows]
        )

    checked = least > -np.inf
    made = assembled(
        robot.chain, bodies, chosen(np.flatnonzero(checked if may is None else checked & ~may)), at_home
    )
    return made if may is None else replace(made, allowed=chosen(np.flatnonzero(checked & may)))


def allowed_name(bodies: Sequence[Body], pair: tuple[int, int]) -> tuple[str, str]:
    """Return the names of two bodies in the form in which the program or the cell allows a contact;
    workpieces of one kind share a name.
    """
    one, other = sorted(_kind(bodies[number]).upper() for number in pair)
    return one, other


def _kind(body: Body) -> str:
    """Return the name of a body; workpieces of one kind have the same name, without their number."""
    return body.name.partition(" ")[0] if body.is_part else body.name


def _least(
    robot: Robot, bodies: tuple[Body, ...], pairs: list[tuple[int, int]], touches: tuple[Touch, ...]
) -> Array:
    """Return, for each pair, the least distance that is allowed while a workpiece is grasped or put down,
    (K,) [m].

    The value is infinite for pairs without such an exception, and minus infinity for pairs that may overlap.
    """
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
                if other.joint == robot.size and other.may_hold:
                    least = min(least, named.get((part.name, None), np.inf))
        found.append(least)
    return np.array(found)


def _pairs(robot: Robot, bodies: tuple[Body, ...]) -> list[tuple[int, int]]:
    """Return the pairs of bodies that must not meet, as indices.

    These are all pairs but three kinds: bodies that never move relative to each other, neighbouring links,
    which meet in the joint between them, and pairs that robot.toml allows.
    """
    shaped = sorted({body.joint for body in bodies if body.is_link})
    neighbours = set(pairwise(shaped))
    joint = np.array([body.joint for body in bodies])
    # A tool from a rack counts as a tool of robot.toml while it is on the flange.
    own = [body.of_robot or (body.of_tool and not body.of_cell) for body in bodies]
    found = []
    # Most bodies of a cell don't move. They form no pairs with each other.
    for one, other in zip(*np.nonzero(np.tril(joint[:, None] != joint[None])), strict=True):
        body, neighbour = bodies[one], bodies[other]
        joints = sorted((body.joint, neighbour.joint))
        if body.is_link and neighbour.is_link and (joints[0], joints[1]) in neighbours:
            continue
        if own[one] and own[other]:
            first, second = sorted((body.name, neighbour.name))
            if (first, second) in robot.allowed:
                continue
        found.append((int(other), int(one)))
    return found


def _ordered(bodies: tuple[Body, ...], one: int, other: int) -> tuple[int, int]:
    """Return the indices of two bodies, with the one that fewer joints move first."""
    return (one, other) if bodies[one].joint <= bodies[other].joint else (other, one)
