"""The guard of the rotary buffer, a PLC that holds the motion when too few lines are left: the number of
lines that must be ahead, and the places at which a program arms and disarms the guard.
"""

from __future__ import annotations

import math

from yarclang.frozen import frozen
from yarclang.pmac.controller import turbo_pmac
from yarclang.robot.model import Robot

_RESERVE = 0.1
"""Maximum delay with which the guard's PLC notices that too few lines are left [s]."""

_SECONDS_AHEAD = 1.0
"""Smallest size of the rotary buffer, as the duration of the motion whose lines it holds [s]."""


@frozen
class Watermarks:
    """Fill levels of the rotary buffer: below `low` lines (I16) it counts as low, from `full` lines (I17) on
    as full. `words` is the size of the buffer.
    """

    low: int
    full: int
    words: int


def watermarks(robot: Robot, segment: float) -> Watermarks:
    """Compute the size of the rotary buffer and its fill levels.

    A hold consumes lines for half of the hold time, so at least these lines must be ahead. A line takes one
    word per axis; two more words per line allow for statements between the lines.

    Args:
        robot: the robot.
        segment: segment time [s].
    """
    controller = turbo_pmac(robot)
    low = math.ceil((controller.hold_time / 2.0 + _RESERVE) / segment)
    full = low + max(5, low // 2)
    lines = max(_SECONDS_AHEAD / segment, 2.0 * full)
    words = max(controller.rotary_words, math.ceil(lines * (len(controller.axes) + 2)))
    return Watermarks(low, full, words)
