"""Measure the distances of joints from the ends of allowed or forbidden ranges ("windows"), at instants and
on pieces of a motion's time.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import JointWindow
from yarclang.collision.course import Course
from yarclang.collision.zones.moved import Pieces, joints
from yarclang.shapes import Array

SLACK = 1e-6
"""Excess over the end of a window [rad or m] up to which a position counts as on the end."""


def room(window: JointWindow, q: Array) -> Array:
    """Return the distances of joint positions (P, n) from the nearer end of each joint's window, (P, n) [rad
    or m].

    A distance is positive inside, negative outside, and infinite for a joint without a window.
    """
    inner: Array = np.minimum(q - window.lower, window.upper - q)
    return inner


def room_on(window: JointWindow, pieces: Pieces, course: Course) -> tuple[Array, Array]:
    """Return a lower and an upper bound of `room` on each of P pieces of a motion's time, (P, n) each.

    A joint whose acceleration is at most A is at most A d² / 8 from the chord between its positions at both
    ends. `room` increases up to its maximum in the middle of the window and then decreases, so its extremes
    follow from the joint's range.
    """
    sag = course.strength[pieces.segment] * ((pieces.end - pieces.begin) ** 2 / 8.0)[:, None]
    before, behind = (joints(course, pieces.segment, time)[0] for time in (pieces.begin, pieces.end))
    low, high = np.minimum(before, behind) - sag, np.maximum(before, behind) + sag
    least = np.minimum(low - window.lower, window.upper - high)
    most = np.minimum(high - window.lower, window.upper - low)
    return least, most
