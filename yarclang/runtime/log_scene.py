"""The robot in a run's log, as Foxglove shows it: its frames over time, and the bodies of its links.

The messages follow Foxglove's schemas FrameTransforms and SceneUpdate. They repeat the content of other
channels of the log, so that viewers need no further file; yarclang itself doesn't read these messages. No
I/O, except that mesh files are read.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from yarclang.files import read_whole
from yarclang.robot.model import Array, Robot
from yarclang.robot.placements import placements
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from yarclang.transforms import quaternions

TRANSFORMS, BODIES = "transforms", "robot"
"""Topics of the robot's frames and of its bodies in the log."""

SCENE_TOPICS = frozenset({TRANSFORMS, BODIES})

EACH = 0.1
"""Shortest time between two messages with the robot's frames [s]. Viewers interpolate between the messages.
"""

_LARGEST_MESH, _LARGEST_MESHES = 1 << 21, 1 << 23
"""Largest mesh file that a log contains, and largest total of all mesh files [bytes]."""

_MEDIA_TYPES = {".stl": "model/stl", ".obj": "model/obj"}

_LINK, _TOOL = (0.80, 0.84, 0.90), (0.42, 0.50, 0.64)

_DIGITS = 7
"""Decimals of lengths [m] and of quaternions."""


class LoggedScene:
    """The frames and bodies of a robot.

    Each joint has a frame with the joint's name, on the joint's axis. The frame moves with the bodies that
    the joint moves; with all joints at zero it has the orientation of {B}.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._zero = _joint_frames(robot)
        on_flange = {name: frame for name, frame in robot.flange_from_frame.items() if name != "FLANGE"}
        self._on_flange = [(name, _pose(frame)) for name, frame in on_flange.items()]
        taken = {"B", "FLANGE", *on_flange}
        joints = (f"{name} (joint)" if name in taken else name for name in robot.joint_names)
        self._names = ("B", *joints, "FLANGE")

    def transforms(self, wall: int, q: Array) -> dict[str, Any]:
        """Return the message with the joint frames at joint positions `q` (n,) [rad or m], for a time of the
        wall clock [ns].
        """
        chain = self._robot.chain
        own = chain.kinematics
        moved = placements(chain.screws, q[None]) if own is None else own.placements(chain, q[None])
        frames = np.tile(np.eye(4), (len(moved), 1, 1))
        frames[:, :3, :] = moved[..., 0]
        frames = np.concatenate((frames @ self._zero, frames[-1:] @ chain.base_from_flange))
        steps = np.linalg.inv(frames[:-1]) @ frames[1:]
        names = self._names
        placed = [
            (parent, child, _pose(step))
            for parent, child, step in zip(names[:-1], names[1:], steps, strict=True)
        ]
        placed += [("FLANGE", name, pose) for name, pose in self._on_flange]
        return {
            "transforms": [
                {
                    "timestamp": _time(wall),
                    "parent_frame_id": parent,
                    "child_frame_id": child,
                    "translation": pose["position"],
                    "rotation": pose["orientation"],
                }
                for parent, child, pose in placed
            ]
        }

    def bodies(self, wall: int) -> dict[str, Any]:
        """Return the message with the bodies of links and mounted tools, each in the frame of the joint that
        moves it.

        A mesh file is left out if it has changed, is too large, or can't be read by viewers.
        """
        frames = self._names
        entities: dict[tuple[str, str], dict[str, Any]] = {}
        remaining = _LARGEST_MESHES
        for name, frame, frame_from_shape, shape, colour in self._shapes():
            key = name, frames[frame]
            entity = entities.setdefault(key, _entity(wall, f"{name} ({frames[frame]})", frames[frame]))
            for kind, primitive, size in _primitives(shape, frame_from_shape, colour, remaining):
                entity[kind].append(primitive)
                remaining -= size
        return {"deletions": [], "entities": [one for one in entities.values() if any(map(one.get, _KINDS))]}

    def _shapes(self) -> Iterator[tuple[str, int, Array, Shape, tuple[float, float, float]]]:
        robot, inverse = self._robot, np.linalg.inv(self._zero)
        for link in robot.shapes:
            yield link.link, link.joint, inverse[link.joint] @ link.base_from_shape, link.shape, _LINK
        for tool in robot.tools:
            for part in tool.shapes if tool.mounted else ():
                placed = inverse[-1] @ robot.chain.base_from_flange @ part.flange_from_shape
                yield tool.name, robot.size, placed, part.shape, _TOOL


def _joint_frames(robot: Robot) -> Array:
    """Return the frames of the base and of the joints with all joints at zero, as (n + 1, 4, 4) matrices [m].

    The origin of each frame is the point of the joint's axis nearest to {B}'s origin; for a sliding joint,
    the origin is that of the previous frame.
    """
    frames = np.tile(np.eye(4), (robot.size + 1, 1, 1))
    for joint, screw in enumerate(robot.chain.screws, 1):
        linear, angular = screw[:3], screw[3:]
        turns = float(angular @ angular)
        frames[joint, :3, 3] = np.cross(angular, linear) / turns if turns > 0.0 else frames[joint - 1, :3, 3]
    return frames


_KINDS = ("cubes", "spheres", "cylinders", "models")


def _entity(wall: int, name: str, frame: str) -> dict[str, Any]:
    return {
        "timestamp": _time(wall),
        "frame_id": frame,
        "id": name,
        "lifetime": {"sec": 0, "nsec": 0},
        "frame_locked": True,
        "metadata": [],
        "arrows": [],
        "cubes": [],
        "spheres": [],
        "cylinders": [],
        "lines": [],
        "triangles": [],
        "texts": [],
        "models": [],
    }


def _primitives(
    shape: Shape, placed: Array, colour: tuple[float, float, float], remaining: int
) -> Iterable[tuple[str, dict[str, Any], int]]:
    """Yield each Foxglove primitive of a shape: the name of its kind, its data, and the size of the mesh file
    in it [bytes]. A mesh file larger than `remaining` bytes is left out.
    """
    common = {"pose": _pose(placed), "color": dict(zip("rgba", (*colour, 1.0), strict=True))}
    match shape:
        case Box(size=size):
            yield "cubes", common | {"size": _vector(size)}, 0
        case Sphere(radius=radius):
            yield "spheres", common | {"size": _vector(np.full(3, 2.0 * radius))}, 0
        case Cylinder(radius=radius, length=length):
            yield "cylinders", common | _cylinder(radius, length), 0
        case Capsule(radius=radius, length=length):
            yield "cylinders", common | _cylinder(radius, length), 0
            for side in (-0.5, 0.5):
                end = placed.copy()
                end[:3, 3] += placed[:3, 2] * side * length
                yield "spheres", common | {"pose": _pose(end), "size": _vector(np.full(3, 2.0 * radius))}, 0
        case Mesh(path=path):
            media_type = _MEDIA_TYPES.get(path.suffix.lower())
            content = _content(shape, min(_LARGEST_MESH, remaining)) if media_type else None
            if content is not None:
                yield (
                    "models",
                    common
                    | {
                        "scale": _vector(shape.unit * np.array(shape.scale)),
                        "override_color": True,
                        "url": "",
                        "media_type": media_type,
                        "data": base64.b64encode(content).decode(),
                    },
                    len(content),
                )


def _content(mesh: Mesh, most: int) -> bytes | None:
    """Return the bytes of a mesh file; None if it can't be read, has changed, or has more than `most`
    bytes.
    """
    try:
        content = read_whole(mesh.path, most)
    except OSError:
        return None
    return content if hashlib.sha256(content).hexdigest() == mesh.digest else None


def _cylinder(radius: float, length: float) -> dict[str, Any]:
    return {
        "size": _vector(np.array([2.0 * radius, 2.0 * radius, length])),
        "bottom_scale": 1.0,
        "top_scale": 1.0,
    }


def _time(wall: int) -> dict[str, int]:
    return {"sec": wall // 10**9, "nsec": wall % 10**9}


def _vector(values: Array) -> dict[str, float]:
    return dict(zip("xyz", np.round(values, _DIGITS).tolist(), strict=True))


def _pose(transform: Array) -> dict[str, dict[str, float]]:
    numbers = np.round(quaternions(transform[:3, :3]), _DIGITS).tolist()
    return {"position": _vector(transform[:3, 3]), "orientation": dict(zip("xyzw", numbers, strict=True))}


_NUMBER, _TEXT, _TRUTH = {"type": "number"}, {"type": "string"}, {"type": "boolean"}


def _object(title: str, **properties: Any) -> dict[str, Any]:
    return {"title": title, "type": "object", "properties": properties}


def _list(items: dict[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": items}


def scene_schemas() -> dict[str, tuple[str, dict[str, Any]]]:
    """Return the name of Foxglove's schema and a JSON schema for each topic, by topic."""
    instant = {"sec": {"type": "integer"}, "nsec": {"type": "integer", "minimum": 0, "maximum": 999_999_999}}
    time, duration = _object("time", **instant), _object("duration", **instant)
    vector = _object("foxglove.Vector3", **dict.fromkeys("xyz", _NUMBER))
    turn = _object("foxglove.Quaternion", **dict.fromkeys("xyzw", _NUMBER))
    pose = _object("foxglove.Pose", position=vector, orientation=turn)
    colour = _object("foxglove.Color", **dict.fromkeys("rgba", _NUMBER))
    common = {"pose": pose, "color": colour}
    size = common | {"size": vector}
    transform = _object(
        "foxglove.FrameTransform",
        timestamp=time,
        parent_frame_id=_TEXT,
        child_frame_id=_TEXT,
        translation=vector,
        rotation=turn,
    )
    model = common | {
        "scale": vector,
        "override_color": _TRUTH,
        "url": _TEXT,
        "media_type": _TEXT,
        "data": {"type": "string", "contentEncoding": "base64"},
    }
    entity = _object(
        "foxglove.SceneEntity",
        timestamp=time,
        frame_id=_TEXT,
        id=_TEXT,
        lifetime=duration,
        frame_locked=_TRUTH,
        metadata=_list(_object("foxglove.KeyValuePair", key=_TEXT, value=_TEXT)),
        arrows=_list(_object("foxglove.ArrowPrimitive")),
        cubes=_list(_object("foxglove.CubePrimitive", **size)),
        spheres=_list(_object("foxglove.SpherePrimitive", **size)),
        cylinders=_list(
            _object("foxglove.CylinderPrimitive", **size, bottom_scale=_NUMBER, top_scale=_NUMBER)
        ),
        lines=_list(_object("foxglove.LinePrimitive")),
        triangles=_list(_object("foxglove.TriangleListPrimitive")),
        texts=_list(_object("foxglove.TextPrimitive")),
        models=_list(_object("foxglove.ModelPrimitive", **model)),
    )
    deletion = _object("foxglove.SceneEntityDeletion", timestamp=time, type={"type": "integer"}, id=_TEXT)
    return {
        TRANSFORMS: (
            "foxglove.FrameTransforms",
            _object("foxglove.FrameTransforms", transforms=_list(transform)),
        ),
        BODIES: (
            "foxglove.SceneUpdate",
            _object("foxglove.SceneUpdate", deletions=_list(deletion), entities=_list(entity)),
        ),
    }
