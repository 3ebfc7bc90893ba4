"""Windows of joint positions: how far the joints are in them or out of them, at instants and on pieces of a motion."""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import JointWindow
from yarclang.collision.course import Course
from yarclang.collision.zones.moved import Pieces, joints
from yarclang.shapes import Array

SLACK = 1e-6
"""What lies beyond the end of a window by no more [rad or m] isn't told from its end."""


def room(window: JointWindow, q: Array) -> Array:
    """How far joints (P, n) are inside of a window, each (P, n) [rad or m]; negative by how far they are out of it, infinite where it is open."""
    inner: Array = np.minimum(q - window.lower, window.upper - q)
    return inner


def room_on(window: JointWindow, pieces: Pieces, course: Course) -> tuple[Array, Array]:
    """The same of pieces of a motion, (P, n) each: at least, and at most.

    A joint is no farther from the straight line between its positions at both ends than its acceleration and the time allow, and room has one kink, where it is
    largest.
    """
    sag = course.strength[pieces.segment] * ((pieces.end - pieces.begin) ** 2 / 8.0)[:, None]
    before, behind = (joints(course, pieces.segment, time)[0] for time in (pieces.begin, pieces.end))
    low, high = np.minimum(before, behind) - sag, np.maximum(before, behind) + sag
    least = np.minimum(low - window.lower, window.upper - high)
    most = np.minimum(high - window.lower, window.upper - low)
    return least, most
