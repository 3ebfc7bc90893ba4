"""RViz markers for the cell around a robot and for the robot's planned motion, as values that each ROS node
converts to visualization_msgs/Marker.

    kinematics = Kinematics(model["urdf"], model["base"])
    for marker in scene_markers(driver.scene()):
        array.markers.append(fill(Marker(), marker, Point))

`scene_markers` and `ghost_markers` each return the complete content of one topic (`~scene` and `~ghost`,
visualization_msgs/MarkerArray in the node's name space, latched). The first marker deletes the previous
drawing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Callable, Iterable, Iterator, Mapping, Sequence, Tuple

from yarclang.ros.node.kinematics import (
    IDENTITY,
    Colour,
    Kinematics,
    Pose,
    Shape,
    Vector,
    origin_of,
    placed,
    quaternion,
    times,
)

ARROW, CUBE, SPHERE, CYLINDER, LINE_STRIP, TEXT, MESH = 0, 1, 2, 3, 4, 9, 10
"""Types of visualization_msgs/Marker: the same numbers in ROS 1 and ROS 2."""
ADD, DELETE_ALL = 0, 3
"""Actions of visualization_msgs/Marker."""

MOST_POINTS = 500
"""Largest number of points of the tool's drawn path."""
MOST_NAMES = 200
"""Largest number of names that are drawn. More names would cover the picture."""

BODY: Colour = (150 / 255, 160 / 255, 150 / 255, 1.0)
CARRIED: Colour = (92 / 255, 110 / 255, 140 / 255, 1.0)
PART: Colour = (176 / 255, 128 / 255, 82 / 255, 1.0)
GHOST: Colour = (60 / 255, 130 / 255, 230 / 255, 0.3)
PATH: Colour = (60 / 255, 130 / 255, 230 / 255, 1.0)
NAME: Colour = (0.1, 0.1, 0.1, 1.0)
ZONES: Mapping[str, Colour] = {
    "allowed": (46 / 255, 160 / 255, 90 / 255, 0.16),
    "forbidden": (214 / 255, 60 / 255, 50 / 255, 0.22),
    "slow": (232 / 255, 178 / 255, 30 / 255, 0.2),
    "posture": (130 / 255, 90 / 255, 200 / 255, 0.2),
}
_RULES = {"allowed": "stay inside", "forbidden": "stay outside", "slow": "slow", "posture": "posture"}
_UNSURE = 0.45
"""Opacity of a part whose position is uncertain."""
_PLANE, _THIN = 2.4, 0.002
"""Edge length and thickness of the piece that is drawn of a half space's border [m]."""
_LETTERS = 0.06
"""Height of the drawn names [m]."""
_WIDTH = 0.008
"""Width of the tool's path [m]."""
_SEEN = 1e-4
"""Largest difference between the first and the last pose of a link in a planned motion at which no
transparent copy of the link is drawn [m, or rad].
"""
_SHAFT: Vector = (0.25, 0.015, 0.03)
"""Length and widths of the arrow that points to the allowed side of a half space [m]."""


@dataclass(frozen=True)
class Marker:
    """A marker, with the fields of visualization_msgs/Marker.

    Attributes:
        pose: frame_from_marker, lengths in m.
        scale: size [m]; scale factors of a mesh.
    """

    namespace: str = ""
    id: int = 0
    type: int = CUBE
    frame_id: str = ""
    pose: Pose = IDENTITY
    scale: Vector = (1.0, 1.0, 1.0)
    colour: Colour = BODY
    points: Tuple[Vector, ...] = ()
    text: str = ""
    mesh: str = ""
    action: int = ADD


def fill(message: Any, marker: Marker, point: Callable[..., Any]) -> Any:
    """Write a marker into a message of ROS 1 or ROS 2, and return the message. The header's stamp stays zero,
    which means the newest transform.

    Args:
        message: a new visualization_msgs/Marker.
        marker: marker to write.
        point: the class geometry_msgs/Point.
    """
    message.header.frame_id = marker.frame_id
    message.ns, message.id = marker.namespace, marker.id
    message.type, message.action = marker.type, marker.action
    at, turned = message.pose.position, message.pose.orientation
    at.x, at.y, at.z = origin_of(marker.pose)
    turned.x, turned.y, turned.z, turned.w = quaternion(marker.pose)
    message.scale.x, message.scale.y, message.scale.z = marker.scale
    message.color.r, message.color.g, message.color.b, message.color.a = marker.colour
    message.points = [point(x=x, y=y, z=z) for x, y, z in marker.points]
    message.text, message.mesh_resource = marker.text, marker.mesh
    # Locked to its frame, a carried body moves with the robot.
    message.frame_locked = True
    return message


def scene_markers(scene: Mapping[str, Any]) -> Tuple[Marker, ...]:
    """Return the markers of the cell around a robot: bodies and parts, transparent zones, and their names.

    Args:
        scene: the reply to the order `scene`.
    """
    made = [Marker(action=DELETE_ALL)]
    named = 0
    for item in scene["items"]:
        for marker in _item(item, named < MOST_NAMES):
            named += marker.type == TEXT
            made.append(_numbered(marker, len(made)))
    return tuple(made)


def ghost_markers(
    kinematics: Kinematics, tool: str, joints: Sequence[str], course: Sequence[Sequence[float]]
) -> Tuple[Marker, ...]:
    """Return the markers of the planned motion: the path of a link's origin as a line, and transparent copies
    of links in their last poses. A link whose last pose equals its first one has no copy.

    Args:
        kinematics: kinematics of the robot.
        tool: the link whose path is drawn.
        joints: names of the joints, in the order of positions.
        course: joint positions [rad or m] of the planned motion; empty to draw nothing.

    Raises:
        ValueError: there is no such link, or the length of a row isn't that of `joints`.
    """
    markers = [Marker(action=DELETE_ALL)]
    if not course:
        return tuple(markers)
    if any(len(row) != len(joints) for row in course):
        raise ValueError(f"the plan has other joints than the {len(joints)} of the robot")
    points = []
    poses = start = kinematics.poses(dict(zip(joints, course[0])))
    for row in thinned(course, MOST_POINTS):
        poses = kinematics.poses(dict(zip(joints, row)))
        if tool not in poses:
            raise ValueError(f"the robot's description has no link {tool!r}")
        points.append(origin_of(poses[tool]))
    # RViz draws no line with only one point.
    points = points * 2 if len(points) == 1 else points
    width = (_WIDTH, 0.0, 0.0)
    markers.append(Marker("path", 1, LINE_STRIP, kinematics.base, IDENTITY, width, PATH, tuple(points)))
    for body in kinematics.bodies:
        if not _differ(start[body.link], poses[body.link]):
            continue
        pose = times(poses[body.link], body.link_from_shape)
        for marker in _shape("ghost", kinematics.base, body.shape, pose, GHOST):
            markers.append(_numbered(marker, len(markers)))
    return tuple(markers)


def _differ(one: Pose, other: Pose) -> bool:
    """Return True if two poses of a link differ visibly. If they don't, a copy of the link in the second pose
    would only cover the link in the first pose.
    """
    return any(abs(a - b) > _SEEN for pair in zip(one, other) for a, b in zip(*pair))


def thinned(rows: Sequence[Any], most: int) -> Tuple[Any, ...]:
    """Return at most `most` rows, evenly selected, including the first and the last."""
    if len(rows) <= most:
        return tuple(rows)
    return tuple(rows[round(at * (len(rows) - 1) / (most - 1))] for at in range(most))


def _item(item: Mapping[str, Any], with_name: bool) -> Iterator[Marker]:
    shape, pose = item["shape"], _pose(item["pose"])
    kind, frame = item["kind"], item["frame"]
    colour = _colour(item)
    top = 0.0
    if shape["type"] == "half-space":
        yield Marker("zones", 0, CUBE, frame, pose, (_PLANE, _PLANE, _THIN), colour)
        side = -1.0 if item["rule"] == "forbidden" else 1.0
        along: Pose = (
            (0.0, 0.0, -side, 0.0),
            (0.0, 1.0, 0.0, 0.0),
            (side, 0.0, 0.0, 0.0),
            IDENTITY[3],
        )
        pose = _corner(pose)
        yield Marker("zones", 0, ARROW, frame, times(pose, along), _SHAFT, (*colour[:3], 0.8))
        top = _SHAFT[0]
    else:
        namespace = {"zone": "zones", "part": "parts"}.get(kind, "bodies")
        for made in _told(shape):
            body, at = made[0], times(pose, made[1])
            top = max(top, at[2][3] - pose[2][3] + _height(body, at))
            yield from _shape(namespace, frame, body, at, colour)
    if with_name:
        x, y, z = origin_of(pose)
        above: Pose = (
            (1.0, 0.0, 0.0, x),
            (0.0, 1.0, 0.0, y),
            (0.0, 0.0, 1.0, z + top + _LETTERS),
            IDENTITY[3],
        )
        yield Marker("names", 0, TEXT, frame, above, (0.0, 0.0, _LETTERS), NAME, text=_text(item))


def _corner(pose: Pose) -> Pose:
    """Return the pose at which a half space's name and arrow are drawn: the upper corner of the drawn part of
    its border plane. The plane's origin isn't used, because the robot often stands there.
    """
    half = 0.45 * _PLANE
    corners = [times(pose, placed((x, y, 0.0))) for x in (-half, half) for y in (-half, half)]
    return max(corners, key=lambda one: (round(one[2][3], 6), one[0][3] + one[1][3]))


def _colour(item: Mapping[str, Any]) -> Colour:
    if item["kind"] == "zone":
        return ZONES.get(item["rule"] or "", ZONES["posture"])
    if item["kind"] == "part":
        return (*PART[:3], 1.0 if item["sure"] else _UNSURE)
    return CARRIED if item["carried"] else BODY


def _text(item: Mapping[str, Any]) -> str:
    if item["kind"] == "zone":
        speed = "" if item["speed"] is None else f", {item['speed']:g} mm/s"
        return f"{item['name']}: {_RULES.get(item['rule'] or '', item['rule'])}{speed}"
    return str(item["name"]) if item["sure"] else f"{item['name']}?"


def _told(shape: Mapping[str, Any]) -> Iterable[Tuple[Shape, Pose]]:
    """Yield a shape of the scene as one or several shapes that RViz can draw, with their poses in the frame
    of the shape. A capsule becomes a cylinder and two spheres.
    """
    kind = shape["type"]
    if kind == "mesh":
        x, y, z = shape["scale"]
        yield Shape("mesh", (x, y, z), shape["mesh"]), IDENTITY
    elif kind == "box":
        x, y, z = shape["size"]
        yield Shape("box", (x, y, z)), IDENTITY
    else:
        edge, length = 2.0 * shape["radius"], shape["length"] or 0.0
        if kind in ("cylinder", "capsule"):
            yield Shape("cylinder", (edge, edge, length)), IDENTITY
        ends = {"sphere": (0.0,), "capsule": (-0.5 * length, 0.5 * length)}.get(kind, ())
        for end in ends:
            at: Pose = (*IDENTITY[:2], (0.0, 0.0, 1.0, end), IDENTITY[3])
            yield Shape("sphere", (edge, edge, edge)), at


def _shape(namespace: str, frame: str, shape: Shape, pose: Pose, colour: Colour) -> Iterator[Marker]:
    """Yield the marker of a shape. A shape without extent gives no marker, because RViz would log errors."""
    if all(shape.size):
        kind = {"box": CUBE, "sphere": SPHERE, "cylinder": CYLINDER, "mesh": MESH}[shape.type]
        yield Marker(namespace, 0, kind, frame, pose, shape.size, colour, mesh=shape.mesh)


def _height(shape: Shape, pose: Pose) -> float:
    """Return the height of the top of a shape in a given pose above the shape's origin [m]. Return 0 for a
    mesh, because its extent isn't known here.
    """
    if shape.type == "mesh":
        return 0.0
    return 0.5 * math.fsum(abs(part) * edge for part, edge in zip(pose[2], shape.size))


def _pose(rows: Sequence[Sequence[float]]) -> Pose:
    a, b, c = ((float(w), float(x), float(y), float(z)) for w, x, y, z in rows[:3])
    return a, b, c, IDENTITY[3]


def _numbered(marker: Marker, number: int) -> Marker:
    return replace(marker, id=number)
