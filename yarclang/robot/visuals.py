"""Read the appearance of a robot's links for pictures: the visual shapes of its URDF.

No check depends on the visual shapes. A shape that can't be read is therefore left out, and the caller draws
the collision shapes instead or, if there are none, bars from joint to joint.
"""

from __future__ import annotations

import hashlib
import itertools

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.joint_points import joint_points, urdf_of
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.link_shapes import link_places, placed_at, shape_of
from yarclang.robot.model import Array, Robot
from yarclang.robot.urdf import Urdf
from yarclang.robot.urdf_shapes import mesh_path
from yarclang.robot.urdf_xml import Element
from yarclang.shapes import Capsule, Mesh, Shape
from yarclang.transforms import constant

Colour = tuple[float, float, float]

STICK = 0.03
"""Radius of the bars of `sticks`, relative to the arm's length."""


@frozen(eq=False)
class Visual:
    """A visual shape of a link.

    `base_from_shape` (4, 4) [m] is its pose with all joints at zero. `joint` is the number of the arm's
    joints between the base and the link. `colour` is red, green and blue from 0 to 1, or None if the URDF
    sets no colour.
    """

    link: str
    joint: int
    base_from_shape: Array
    shape: Shape
    colour: Colour | None


def visual_shapes(robot: Robot) -> tuple[Visual, ...]:
    """Return all visual shapes of a robot. The result is empty if the robot wasn't read from files, or if its
    files have changed and can't be read any more.
    """
    found = urdf_of(robot)
    if found is None:
        return ()
    urdf, base = found
    places = link_places(urdf, [urdf.joints[name] for name in robot.joint_names])
    folder = (robot.folder / robot.urdf).parent
    base_from_root = np.linalg.inv(places[base][0])
    materials = urdf.root.all("material") if urdf.root is not None else ()
    colours = {one.attributes.get("name", ""): _colour(urdf, one) for one in materials}
    visuals: list[Visual] = []
    for name, link in urdf.links.items():
        root_from_link, joint = places[name]
        for body in link.all("visual"):
            geometry = body.first("geometry")
            if geometry is None or not geometry.children:
                continue
            shape = geometry.children[0]
            if shape.tag == "mesh":
                path = mesh_path(shape.attributes.get("filename", ""), folder)
                scale = urdf.numbers(shape, "scale", 3, (1.0, 1.0, 1.0))
                if path is None or scale is None:
                    continue
                digest = hashlib.sha256(path.read_bytes()).hexdigest()
                result: Shape = Mesh(path.absolute(), 1.0, digest, (scale[0], scale[1], scale[2]))
            else:
                result = shape_of(urdf, shape, folder)
            placed = base_from_root @ root_from_link @ placed_at(urdf, body.first("origin"))
            material = body.first("material")
            colour = None
            if material is not None:
                colour = _colour(urdf, material) or colours.get(material.attributes.get("name", ""))
            visuals.append(Visual(name, joint, constant(placed), result, colour))
    return tuple(visuals)


def sticks(robot: Robot) -> tuple[Visual, ...]:
    """Return bars from {B} along the joints to the flange. They are drawn for a robot whose links have no
    shapes that can be drawn.
    """
    joints = joint_points(robot)
    if joints is None:
        return ()
    points = np.vstack((np.zeros(3), joints))
    radius = STICK * arm_length(robot.chain, np.eye(4))
    bars: list[Visual] = []
    for joint, (start, end) in enumerate(itertools.pairwise(points)):
        length = float(np.linalg.norm(end - start))
        if length < radius:
            continue
        pose = np.eye(4)
        z = (end - start) / length
        x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
        x /= np.linalg.norm(x)
        pose[:3, :3] = np.column_stack((x, np.cross(z, x), z))
        pose[:3, 3] = (start + end) / 2.0
        name = robot.joint_names[joint - 1] if joint else "B"
        bars.append(Visual(name, joint, constant(pose), Capsule(radius, length), None))
    return tuple(bars)


def _colour(urdf: Urdf, material: Element) -> Colour | None:
    parts = urdf.numbers(material.first("color"), "rgba", 4)
    return None if parts is None else (parts[0], parts[1], parts[2])
