"""The elbow of an arm as docs/cells.md defines it.

The elbow is on the turning axis that is farthest from both shoulder and flange, with all joints at zero.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array, Lines

LEAST = 0.01
"""Least distance of the elbow from the shoulder and the flange [m]."""
_EQUAL = 1.0 + 1e-9
"""Largest ratio of two distances that count as equal. Of several axes at equal distances, the first is
chosen.
"""


def find_elbow(lines: Lines, flange: Array) -> tuple[int, Array] | None:
    """Find the elbow of an arm.

    Args:
        lines: the axes of all joints.
        flange: (3,) origin of the flange [m].

    Returns:
        The index of the elbow's joint and the elbow's point (3,) [m]; None if the arm has no elbow.
    """
    turning = [joint for joint, turn in enumerate(lines.turn.tolist()) if turn]
    if len(turning) < 2:
        return None
    shoulder = _shoulder(lines, turning[0], turning[1])
    farthest, most = None, LEAST
    for joint in turning[1:]:
        elbow = _foot(lines, joint, shoulder)
        # The elbow is on the axis whose distance from the nearer one of shoulder and flange is largest.
        nearer = min(_length(elbow - shoulder), _length(_foot(lines, joint, flange) - flange))
        if nearer > most * _EQUAL:
            farthest, most = (joint, elbow), nearer
    return farthest


def _foot(lines: Lines, joint: int, point: Array) -> Array:
    """Return the point of an axis that is nearest to a point (3,)."""
    axis, on_axis = lines.axes[joint], lines.points[joint]
    # The vector from the foot to the point is the part of `point - on_axis` that is perpendicular to the
    # axis.
    return np.asarray(point - np.cross(axis, np.cross(point - on_axis, axis)), dtype=np.float64)


def _shoulder(lines: Lines, one: int, other: int) -> Array:
    """Return the shoulder: the point of one axis that is nearest to another axis.

    If the axes are parallel, the other axis's point nearest to the base's origin is projected onto the first
    axis.
    """
    first, second = lines.axes[one], lines.axes[other]
    cosine = float(first @ second)
    sine = np.cross(first, second)
    # If the axes are parallel (|sine| = 0), the two equations below are singular.
    if float(sine @ sine) < 1e-12:
        return _foot(lines, one, lines.points[other])
    # The points a + s u and b + t w of both axes are nearest to each other where their difference is
    # perpendicular to u and w. This gives two linear equations for s and t.
    apart = lines.points[other] - lines.points[one]
    equations = np.array([[1.0, -cosine], [cosine, -1.0]])
    along = np.linalg.solve(equations, np.array([first @ apart, second @ apart]))
    return np.asarray(lines.points[one] + first * along[0], dtype=np.float64)


def _length(vector: Array) -> float:
    return float(np.sqrt(vector @ vector))
