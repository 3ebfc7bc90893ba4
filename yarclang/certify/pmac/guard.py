"""The guard of the rotary buffer, which acts if the computer that feeds the buffer fails.

While the guard is armed, the controller's PLC 29 stops the motion on its path as soon as fewer than I16 lines
are ahead.

A text arms the guard before the first move, and disarms it only when the last lines are in the buffer.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.pmac.own import Armed, Marks, own_of
from yarclang.certify.read.text import Barred, ControllerText
from yarclang.pmac.controller import turbo_pmac
from yarclang.robot.model import Robot
from yarclang.units import MS

LATE = 0.1
"""Largest delay with which the guard's PLC notices that the buffer runs low [s]."""

AHEAD = 2
"""Number of lines that the controller takes out of the buffer before it executes them.

A spline needs the next two points (TUM 289).
"""

_ROUNDING = 1e-9

Fault = str


def check_guard(text: ControllerText, robot: Robot) -> Iterator[Fault]:
    """Check that the buffer has enough lines for the motion to stop on its path when the guard acts.

    A hold slows the program evenly to a stop within the robot's hold time T. During the hold, the program
    advances as far as it would at full speed in T / 2. The PLC may start the hold late by `LATE`. The lines
    that are ahead when the guard acts must therefore last for T / 2 + `LATE`.

    Args:
        text: the controller text, as the judge has read it.
        robot: defines the hold time, and the number of words of a line in the buffer.
    """
    marks = own_of(text).marks
    if marks is None:
        if own_of(text).arms:
            yield (
                f"line {own_of(text).arms[0].line} arms or disarms the guard of the rotary, in a text for a "
                "program buffer"
            )
        return
    moving = [run.segment_ms * MS for run in text.runs]
    if moving:
        yield from _check_marks(marks, min(moving), robot)
    for moves, arms in _legs(text):
        yield from _check_leg(moves, arms, marks)


def _check_marks(marks: Marks, segment: float, robot: Robot) -> Iterator[Fault]:
    """Check the buffer's marks (I16, I17, size) for a text whose shortest segment lasts `segment` [s]."""
    controller = turbo_pmac(robot)
    # While the program brakes evenly for a time T, it advances as far as it would at full speed in T / 2.
    needed = controller.hold_time / 2.0 + LATE
    if marks.low * segment < needed * (1.0 - _ROUNDING):
        yield (
            f"I16={marks.low}: {marks.low} lines of {segment / MS:.6g} ms are {marks.low * segment:.3g} s "
            f"of motion, but a late hold needs {needed:.3g} s"
        )
    if marks.full <= marks.low:
        yield f"I17={marks.full}: the buffer would count as full and as low at once, since I16={marks.low}"
    # Each value of a move line takes one word; two more are reserved for each line.
    capacity = marks.words // (len(controller.axes) + 2)
    if marks.full + AHEAD > capacity:
        yield (
            f"I17={marks.full}: the buffer of {marks.words} words holds {capacity} lines, so that it would "
            "never count as full"
        )
    if marks.words < controller.rotary_words:
        yield f"DEFINE ROT {marks.words}: robot.toml gives the buffer {controller.rotary_words} words"


def _check_leg(moves: NDArray[np.int64], arms: list[Armed], marks: Marks) -> Iterator[Fault]:
    """Check where the guard is armed and disarmed in the lines between two barriers.

    The guard must be armed if these lines do not fit into the buffer as a whole.
    """
    count = len(moves)
    # The whole leg is in the buffer before the motion starts, so the computer can't be late.
    if count <= marks.full + AHEAD:
        if arms:
            yield (
                f"line {arms[0].line} arms or disarms the guard over {count} move lines, which are in the "
                f"buffer as a whole before they start (I17={marks.full})"
            )
        return
    first = int(moves[0])
    if not arms or not arms[0].on or arms[0].line > first:
        yield (
            f"the guard isn't armed (P8100=1) before the move in line {first}, after which {count - 1} "
            "more moves follow"
        )
        return
    if len(arms) < 2:
        yield (
            f"the guard is armed in line {arms[0].line} and never disarmed: it would hold the motion at its "
            "end"
        )
        return
    if len(arms) > 2 or arms[1].on:
        extra = arms[1] if arms[1].on else arms[2]
        yield f"line {extra.line} arms or disarms the guard once more"
        return
    ahead = count - int(np.searchsorted(moves, arms[1].line))
    if not marks.low <= ahead <= marks.low + AHEAD:
        yield (
            f"line {arms[1].line} disarms the guard with {ahead} moves left: {marks.low} (I16) to "
            f"{marks.low + AHEAD} are allowed"
        )


def _legs(text: ControllerText) -> Iterator[tuple[NDArray[np.int64], list[Armed]]]:
    """Yield the move lines of each part between two barriers, and its lines that arm or disarm the guard."""
    barriers = [item.line for item in text.course if isinstance(item, Barred)]
    lines = np.concatenate([run.lines for run in text.runs]) if text.runs else np.empty(0, dtype=np.int64)
    for begin, end in pairwise((0, *barriers, sys.maxsize)):
        first, last = np.searchsorted(lines, (begin, end))
        yield lines[first:last], [one for one in own_of(text).arms if begin <= one.line < end]
