"""Compute the poses of a URDF's collision shapes on the arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from yarclang.consulted import digest
from yarclang.files import LARGEST_MESH, read_whole
from yarclang.robot.model import Array, LinkShape
from yarclang.robot.urdf import Joint, Urdf
from yarclang.robot.urdf_shapes import mesh_path
from yarclang.robot.urdf_xml import Element
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from yarclang.transforms import constant, rpy_rotation

T = TypeVar("T")

_NONE: Mapping[str, int] = MappingProxyType({})


def link_shapes(
    urdf: Urdf, folder: Path, base: str, moving: Sequence[Joint], pieces: Mapping[str, int] = _NONE
) -> tuple[LinkShape, ...]:
    """Return all collision shapes of the links, in the order of the URDF. Joints that don't belong to the arm
    are at zero.

    Args:
        urdf: a URDF without errors.
        folder: its folder; mesh names are relative to it.
        base: the link that is {B}.
        moving: the arm's moving joints, from the base to the flange.
        pieces: for each link name, the largest number of convex pieces into which the link's meshes are
            divided.
    """
    places = link_places(urdf, moving)
    base_from_root = np.linalg.inv(places[base][0])
    shapes: list[LinkShape] = []
    for name, link in urdf.links.items():
        root_from_link, joint = places[name]
        for body in link.all("collision"):
            origin = body.first("origin")
            placed = base_from_root @ root_from_link @ placed_at(urdf, origin)
            shape = shape_of(urdf, _required(body.first("geometry")).children[0], folder)
            if isinstance(shape, Mesh):
                shape = replace(shape, pieces=pieces.get(name, 0))
            shapes.append(LinkShape(name, joint, constant(placed), shape))
    return tuple(shapes)


def link_places(urdf: Urdf, moving: Sequence[Joint]) -> dict[str, tuple[Array, int]]:
    """Return two values for each link: its pose root_from_link (4, 4) with all joints at zero, and the number
    of moving joints between the root and the link.
    """
    below: dict[str, list[Joint]] = {}
    for joint in urdf.joints.values():
        below.setdefault(joint.parent, []).append(joint)
    children = {joint.child for joint in urdf.joints.values()}
    number = {joint.name: at + 1 for at, joint in enumerate(moving)}
    places = {link: (np.eye(4), 0) for link in urdf.links if link not in children}
    todo = list(places)
    while todo:
        here = todo.pop()
        pose, count = places[here]
        for joint in below.get(here, []):
            step = np.eye(4)
            step[:3, :3], step[:3, 3] = rpy_rotation(np.array(joint.rpy)), joint.xyz
            places[joint.child] = pose @ step, number.get(joint.name, count)
            todo.append(joint.child)
    return places


def placed_at(urdf: Urdf, origin: Element | None) -> Array:
    """Return the pose of an <origin> element that was checked, relative to its link, as (4, 4); the identity
    for None.
    """
    placed = np.eye(4)
    rpy = urdf.numbers(origin, "rpy", 3, (0.0, 0.0, 0.0))
    placed[:3, :3] = rpy_rotation(np.array(_required(rpy)))
    placed[:3, 3] = _required(urdf.numbers(origin, "xyz", 3, (0.0, 0.0, 0.0)))
    return placed


def shape_of(urdf: Urdf, shape: Element, folder: Path) -> Shape:
    """Return the shape that an XML element describes; urdf_shapes.py has checked the element."""

    def size(key: str) -> float:
        return _required(urdf.numbers(shape, key, 1))[0]

    match shape.tag:
        case "box":
            return Box(constant(np.array(_required(urdf.numbers(shape, "size", 3)))))
        case "sphere":
            return Sphere(size("radius"))
        case "cylinder":
            return Cylinder(size("radius"), size("length"))
        case "capsule":
            return Capsule(size("radius"), size("length"))
    path = _required(mesh_path(shape.attributes["filename"], folder))
    x, y, z = _required(urdf.numbers(shape, "scale", 3, (1.0, 1.0, 1.0)))
    return Mesh(path.absolute(), 1.0, digest(read_whole(path, LARGEST_MESH)), (x, y, z))


def _required(value: T | None) -> T:
    if value is None:
        raise AssertionError("a URDF with errors has passed its checks")
    return value
