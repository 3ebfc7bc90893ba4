"""Poses and shapes of the links of a URDF, for the drawings of the ROS nodes. The forward kinematics needs
no library.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import Dict, Mapping, Tuple

Row = Tuple[float, float, float, float]
Pose = Tuple[Row, Row, Row, Row]
"""A homogeneous matrix (4, 4) [m]."""
Vector = Tuple[float, float, float]
Colour = Tuple[float, float, float, float]
"""Red, green, blue and opacity, from 0 to 1."""

IDENTITY: Pose = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))

_TURNS, _SLIDES = ("revolute", "continuous"), ("prismatic",)


@dataclass(frozen=True)
class Shape:
    """A shape in a frame of its own. Boxes, spheres and cylinders are centered at the origin.

    Attributes:
        type: `box`, `sphere`, `cylinder` (along z) or `mesh`.
        size: edges of a box, extents of a sphere or a cylinder [m]; scale factors of a mesh.
        mesh: file of a mesh.
    """

    type: str
    size: Vector
    mesh: str = ""


@dataclass(frozen=True)
class Body:
    """A shape that is fixed to a link.

    Attributes:
        link: name of the link.
        shape: the shape.
        link_from_shape: pose of the shape.
        colour: color of the shape; None if the URDF gives none.
    """

    link: str
    shape: Shape
    link_from_shape: Pose
    colour: Colour | None = None


@dataclass(frozen=True)
class _Joint:
    name: str
    kind: str
    parent: str
    child: str
    parent_from_joint: Pose
    axis: Vector


class Kinematics:
    """Poses and shapes of the links of a URDF.

    Args:
        urdf: text of the URDF, from the order `model`.
        base: link to which poses are relative.

    Attributes:
        base: link to which poses are relative.
        bodies: visual shapes of the links, or the collision shapes of links without visual ones.

    Raises:
        ValueError: the text isn't a URDF whose links and joints form a tree, or it has no link `base`.
    """

    def __init__(self, urdf: str, base: str) -> None:
        try:
            root = ET.fromstring(urdf)
        except ET.ParseError as error:
            raise ValueError(f"the robot's description is no XML: {error}") from None
        self.base = base
        self._links = [_name(link) for link in root.findall("link")]
        self._joints = _in_turn(self._links, [_joint(one) for one in root.findall("joint")])
        if base not in self._links:
            raise ValueError(f"the robot's description has no link {base!r}")
        colours = {_name(one): _rgba(one) for one in root.findall("material")}
        self.bodies = tuple(
            body for link in root.findall("link") for body in _bodies(link, colours) if body is not None
        )

    def poses(self, positions: Mapping[str, float]) -> Dict[str, Pose]:
        """Return the pose of each link, base_from_link, by the name of the link.

        Args:
            positions: joint positions by joint name [rad or m]; other joints are at zero.
        """
        poses_by_link: Dict[str, Pose] = {}
        children = {joint.child for joint in self._joints}
        for link in self._links:
            if link not in children:
                poses_by_link[link] = IDENTITY
        for joint in self._joints:
            moved = _moved(joint, positions.get(joint.name, 0.0))
            poses_by_link[joint.child] = times(
                times(poses_by_link[joint.parent], joint.parent_from_joint), moved
            )
        from_root = inverse(poses_by_link[self.base])
        return {link: times(from_root, pose) for link, pose in poses_by_link.items()}


def times(one: Pose, other: Pose) -> Pose:
    """Return the product of two poses."""
    rows = [tuple(sum(row[k] * other[k][column] for k in range(4)) for column in range(4)) for row in one]
    return (rows[0], rows[1], rows[2], rows[3])  # type: ignore[return-value]


def inverse(pose: Pose) -> Pose:
    """Return the inverse of a pose."""
    turned = [[pose[column][row] for column in range(3)] for row in range(3)]
    rows = [(*row, -sum(row[k] * pose[k][3] for k in range(3))) for row in turned]
    return (rows[0], rows[1], rows[2], IDENTITY[3])  # type: ignore[return-value]


def origin_of(pose: Pose) -> Vector:
    """Return the origin of a pose's frame [m]."""
    return pose[0][3], pose[1][3], pose[2][3]


def placed(xyz: Vector, rpy: Vector = (0.0, 0.0, 0.0)) -> Pose:
    """Return the pose of an <origin> element: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    (cr, cp, cy), (sr, sp, sy) = [math.cos(one) for one in rpy], [math.sin(one) for one in rpy]
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, xyz[0]),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, xyz[1]),
        (-sp, cp * sr, cp * cr, xyz[2]),
        IDENTITY[3],
    )


def quaternion(pose: Pose) -> Tuple[float, float, float, float]:
    """Return the rotation of a pose as a unit quaternion x y z w, by Shepperd's method (the largest component
    is computed first).
    """
    (a, b, c, _), (d, e, f, _), (g, h, i, _) = pose[:3]
    squares = (1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i, 1.0 + a + e + i)
    rows = (
        (squares[0], b + d, c + g, h - f),
        (b + d, squares[1], f + h, c - g),
        (c + g, f + h, squares[2], d - b),
        (h - f, c - g, d - b, squares[3]),
    )
    found = rows[max(range(4), key=squares.__getitem__)]
    norm = math.sqrt(sum(one * one for one in found))
    x, y, z, w = (one / norm for one in found)
    return x, y, z, w


def _in_turn(links: list[str], joints: list[_Joint]) -> Tuple[_Joint, ...]:
    """Return the joints in an order in which parents come before children."""
    below: Dict[str, list[_Joint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    children = {joint.child for joint in joints}
    todo, found = [link for link in links if link not in children], []
    while todo:
        for joint in below.pop(todo.pop(), []):
            found.append(joint)
            todo.append(joint.child)
    if len(found) != len(joints) or len(children) != len(joints) or not children <= set(links):
        raise ValueError("the links and joints of the robot's description don't form a tree")
    return tuple(found)


def _joint(one: ET.Element) -> _Joint:
    axis = one.find("axis")
    direction = (1.0, 0.0, 0.0) if axis is None else _three(axis, "xyz", (1.0, 0.0, 0.0))
    norm = math.sqrt(sum(part * part for part in direction))
    if not norm > 0.0:
        raise ValueError(f"the axis of joint {_name(one)!r} has no direction")
    x, y, z = (part / norm for part in direction)
    ends = [one.find(tag) for tag in ("parent", "child")]
    parent, child = ("" if end is None else end.get("link", "") for end in ends)
    return _Joint(_name(one), one.get("type", ""), parent, child, _origin(one), (x, y, z))


def _moved(joint: _Joint, value: float) -> Pose:
    """Return the pose of a joint's child link in the joint's frame at the joint position `value`: a rotation
    by Rodrigues' formula, or a translation.
    """
    x, y, z = joint.axis
    if joint.kind in _SLIDES:
        return placed((x * value, y * value, z * value))
    if joint.kind not in _TURNS:
        return IDENTITY
    c, s = math.cos(value), math.sin(value)
    k = 1.0 - c
    return (
        (c + x * x * k, x * y * k - z * s, x * z * k + y * s, 0.0),
        (y * x * k + z * s, c + y * y * k, y * z * k - x * s, 0.0),
        (z * x * k - y * s, z * y * k + x * s, c + z * z * k, 0.0),
        IDENTITY[3],
    )


def _bodies(link: ET.Element, colours: Mapping[str, Colour | None]) -> Tuple[Body | None, ...]:
    shown = link.findall("visual") or link.findall("collision")
    return tuple(_body(_name(link), one, colours) for one in shown)


def _body(link: str, one: ET.Element, colours: Mapping[str, Colour | None]) -> Body | None:
    """Return the body that a <visual> or <collision> element describes; None if its shape isn't in URDF
    version 1.0.
    """
    geometry, material = one.find("geometry"), one.find("material")
    shape = None if geometry is None else _shape(geometry)
    if shape is None:
        return None
    colour = None if material is None else _rgba(material) or colours.get(_name(material))
    return Body(link, shape, _origin(one), colour)


def _shape(geometry: ET.Element) -> Shape | None:
    for element in geometry:
        if element.tag == "box":
            return Shape("box", _three(element, "size", (0.0, 0.0, 0.0)))
        if element.tag == "sphere":
            edge = 2.0 * _number(element, "radius")
            return Shape("sphere", (edge, edge, edge))
        if element.tag == "cylinder":
            edge = 2.0 * _number(element, "radius")
            return Shape("cylinder", (edge, edge, _number(element, "length")))
        if element.tag == "mesh":
            return Shape("mesh", _three(element, "scale", (1.0, 1.0, 1.0)), element.get("filename", ""))
    return None


def _rgba(material: ET.Element) -> Colour | None:
    colour = material.find("color")
    if colour is None:
        return None
    red, green, blue, opacity = _numbers(colour, "rgba", 4)
    return red, green, blue, opacity


def _origin(one: ET.Element) -> Pose:
    origin = one.find("origin")
    if origin is None:
        return IDENTITY
    zero = (0.0, 0.0, 0.0)
    return placed(_three(origin, "xyz", zero), _three(origin, "rpy", zero))


def _three(one: ET.Element, key: str, default: Vector) -> Vector:
    if key not in one.attrib:
        return default
    x, y, z = _numbers(one, key, 3)
    return x, y, z


def _number(one: ET.Element, key: str) -> float:
    return _numbers(one, key, 1)[0]


def _numbers(one: ET.Element, key: str, count: int) -> list[float]:
    text = one.get(key, "")
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != count or not all(map(math.isfinite, found)):
        said = f"{key}={text[:60]!r} of <{one.tag}>"
        raise ValueError(f"the robot's description has {said} instead of {count} numbers")
    return found


def _name(one: ET.Element) -> str:
    return one.get("name", "")
