"""The rotary's guard: how many lines must lie ahead, and where a program arms and disarms it."""

from __future__ import annotations

import math

from yarclang.frozen import frozen
from yarclang.pmac.controller import turbo_pmac
from yarclang.robot.model import Robot

_RESERVE = 0.1
"""What the guard's own PLC may be late [s]."""

_SECONDS_AHEAD = 1.0
"""The rotary holds at least so much of a program."""


@frozen
class Watermarks:
    """`low` and `full` are I16 and I17 in program lines, `words` the size of the rotary buffer."""

    low: int
    full: int
    words: int


def watermarks(robot: Robot, segment: float) -> Watermarks:
    """For segments of `segment` [s]: a hold takes half the hold time of the program, and that much must be ahead.

    A line costs one word an axis; two more are reckoned for what stands between the lines.
    """
    controller = turbo_pmac(robot)
    low = math.ceil((controller.hold_time / 2.0 + _RESERVE) / segment)
    full = low + max(5, low // 2)
    lines = max(_SECONDS_AHEAD / segment, 2.0 * full)
    words = max(controller.rotary_words, math.ceil(lines * (len(controller.axes) + 2)))
    return Watermarks(low, full, words)
