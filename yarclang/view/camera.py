"""Choose the camera's first view of a scene: near the robot, from above, and from the side with the fewest
obstacles between camera and robot.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.stage import Stage, moved_by

_AROUND = 16
_HEIGHT = 0.40
"""Height of the camera above the point at which it looks, divided by its horizontal distance from this
point.
"""
_FIRST = np.deg2rad(39.0)
"""Side from which the camera looks if no obstacle is on any side [rad]."""
_MOST_POINTS, _MOST_TRIANGLES = 150, 4_000


def shown_box(stage: Stage, *, whole: bool) -> tuple[Array, Array]:
    """Return the box around the robot at its start and around its path, as smallest and largest coordinates
    (3,) [m].

    Args:
        stage: the scene that is drawn.
        whole: True to include the obstacles.
    """
    points = np.concatenate([stage.way.points, np.zeros((1, 3)), *_corners(stage, around=whole)])
    return points.min(axis=0), points.max(axis=0)


def first_view(stage: Stage) -> tuple[Array, Array]:
    """Return the camera's position, and the point at which it looks, (3,) each [m], for the first view of
    a scene.
    """
    low, high = shown_box(stage, whole=False)
    middle = (low + high) / 2.0
    away = 0.3 + 1.05 * float(np.linalg.norm(high - low))
    points = np.concatenate([stage.way.points, *_corners(stage, around=False)])
    points = points[:: -(-len(points) // _MOST_POINTS)]
    angles = _FIRST + np.arange(_AROUND) * (2.0 * np.pi / _AROUND)
    # The usual side comes first. Of equally good sides, the nearest one to it is chosen.
    order = np.argsort(
        np.abs(np.arange(_AROUND) - _AROUND * (np.arange(_AROUND) > _AROUND // 2)), kind="stable"
    )
    eyes = [
        middle + away * np.array([np.cos(angle), np.sin(angle), _HEIGHT]) for angle in angles[order].tolist()
    ]
    triangles = _obstacles(stage)
    return min(eyes, key=lambda eye: hidden(eye, points, triangles)), middle


def hidden(eye: Array, points: Array, triangles: Array) -> int:
    """Return the number of points that triangles hide from the camera (Moeller and Trumbore, 1997).

    Args:
        eye: (3,) position of the camera [m].
        points: (P, 3) [m].
        triangles: (T, 3, 3) corners of the triangles [m].
    """
    rays = points - eye
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(rays[:, None], b[None])
    across = np.einsum("ti,pti->pt", a, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        start = eye - triangles[:, 0]
        u = np.einsum("ti,pti->pt", start, normal) / across
        side = np.cross(start, a)
        v = np.einsum("pi,ti->pt", rays, side) / across
        far = np.einsum("ti,ti->t", b, side) / across
        through = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (far > 0.0) & (far < 0.999)
    return int(through.any(axis=1).sum())


def _corners(stage: Stage, *, around: bool) -> list[Array]:
    """Return the vertices of the robot's bodies at the start; with `around` also those of the obstacles."""
    moved = moved_by(stage.robot.chain, stage.track.at(np.zeros(1))[0][0])
    found = []
    for item in stage.items:
        if item.kind in {"robot", "tool"} or (around and item.kind == "obstacle"):
            placed = moved[item.joint] @ item.base_from_item
            found.append(item.solid.vertices @ placed[:3, :3].T + placed[:3, 3])
    return found


def _obstacles(stage: Stage) -> Array:
    """Return the triangles (T, 3, 3) of the obstacles [m]."""
    found = [np.zeros((0, 3, 3))]
    for item in stage.items:
        if item.kind == "obstacle":
            corners = item.solid.vertices @ item.base_from_item[:3, :3].T + item.base_from_item[:3, 3]
            found.append(corners[item.solid.faces])
    every = np.concatenate(found)
    return every[:: max(-(-len(every) // _MOST_TRIANGLES), 1)]
