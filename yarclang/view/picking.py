"""Find the target of a click: the point nearest to the ray from the camera through the mouse."""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.stage import Way

ANGLE = 0.02
"""Largest angle between the ray of a click and its target [rad], about 12 pixels."""


def beside(points: Array, eye: Array, direction: Array) -> tuple[int, float]:
    """Return the index of the point with the smallest angle to a ray from the camera, and this angle [rad].

    If no point is in front of the camera, the result is -1 and infinity.

    Args:
        points: (N, 3) [m].
        eye: (3,) position of the camera [m].
        direction: (3,) direction of the ray.
    """
    if not len(points):
        return -1, np.inf
    arms = points - eye
    along = arms @ (direction / np.linalg.norm(direction))
    across = np.sqrt(np.maximum(np.einsum("ni,ni->n", arms, arms) - along**2, 0.0))
    angle = np.where(along > 0.0, np.arctan2(across, along), np.inf)
    nearest = int(np.argmin(angle))
    return (nearest, float(angle[nearest])) if np.isfinite(angle[nearest]) else (-1, np.inf)


def picked_time(way: Way, eye: Array, direction: Array) -> float | None:
    """Return the time [s] at which the moving frame is at the clicked point of its path; None for clicks
    beside the path.

    The points of a long straight path are far apart, so the lines between them are searched too.
    """
    if len(way.points) < 2:
        return None
    inside = np.ones(len(way.points) - 1, dtype=np.bool_)
    inside[way.breaks[1:-1] - 1] = False  # separate sections aren't connected by a line
    first = np.flatnonzero(inside)
    a, b = way.points[first], way.points[first + 1]
    ray = direction / np.linalg.norm(direction)
    # Find the point of each line that is nearest to the ray.
    line, arm = b - a, a - eye
    flat_line, flat_arm = line - (line @ ray)[:, None] * ray, arm - (arm @ ray)[:, None] * ray
    square = np.einsum("ni,ni->n", flat_line, flat_line)
    share = -np.einsum("ni,ni->n", flat_arm, flat_line) / np.where(square > 0.0, square, 1.0)
    share = np.clip(share, 0.0, 1.0)
    number, angle = beside(a + share[:, None] * line, eye, direction)
    if number < 0 or angle > ANGLE:
        return None
    row = first[number]
    return float(way.times[row] + share[number] * (way.times[row + 1] - way.times[row]))
