"""Measure how far joints are inside or outside windows of joint positions, at instants and on pieces of a
motion.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import JointWindow
from yarclang.collision.course import Course
from yarclang.collision.zones.moved import Pieces, joints
from yarclang.shapes import Array

SLACK = 1e-6
"""Positions that exceed the end of a window by no more than this [rad or m] count as on its end."""


def room(window: JointWindow, q: Array) -> Array:
    """Return how far joints (P, n) are inside of a window, (P, n) [rad or m]; negative outside, infinite
    where it is open.
    """
    inner: Array = np.minimum(q - window.lower, window.upper - q)
    return inner


def room_on(window: JointWindow, pieces: Pieces, course: Course) -> tuple[Array, Array]:
    """Return lower and upper bounds of `room` on pieces of a motion, (P, n) each.

    A joint is no farther from the chord between its positions at both ends than its acceleration times d² /
    8. `room` increases up to its maximum in the middle of the window and then decreases, so that its extremes
    follow from the joint's range.
    """
    sag = course.strength[pieces.segment] * ((pieces.end - pieces.begin) ** 2 / 8.0)[:, None]
    before, behind = (joints(course, pieces.segment, time)[0] for time in (pieces.begin, pieces.end))
    low, high = np.minimum(before, behind) - sag, np.maximum(before, behind) + sag
    least = np.minimum(low - window.lower, window.upper - high)
    most = np.minimum(high - window.lower, window.upper - low)
    return least, most
