"""The guard of the rotary buffer, which acts if the computer that feeds the buffer fails.

While the guard is armed, the controller's PLC 29 stops the motion on its path as soon as fewer than I16 lines
are ahead.

A text arms the guard before the first move, and disarms it after the last one. Enough lines follow, so that
the guard doesn't hold the last moves. The controller counts all lines that it stores, not only those that
move the robot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.pmac.own import Armed, Marks, own_of
from yarclang.certify.read.text import Barred, ControllerText
from yarclang.frozen import frozen
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
    advances as far as it would at full speed in T / 2. The PLC may start the hold late by `LATE`. The moves
    that are ahead when the guard acts must therefore last for T / 2 + `LATE`. The controller counts lines;
    lines that don't move the robot take no time.

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
    # While the program brakes evenly for a time T, it advances as far as it would at full speed in T / 2.
    needed = turbo_pmac(robot).hold_time / 2.0 + LATE
    shortest = min((run.segment_ms * MS for run in text.runs), default=None)
    if shortest is not None:
        yield from _check_marks(marks, shortest, needed, robot)
        moves = math.ceil(needed * (1.0 - _ROUNDING) / shortest)
        for stretch in _stretches(text):
            yield from _check_stretch(stretch, moves, marks)


def _check_marks(marks: Marks, segment: float, needed: float, robot: Robot) -> Iterator[Fault]:
    """Check the buffer's marks (I16, I17, size) for a text whose shortest segment lasts `segment` [s], if a
    late hold needs `needed` [s] of motion.
    """
    controller = turbo_pmac(robot)
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


@frozen(eq=False)
class _Stretch:
    """The lines between two barriers.

    Attributes:
        first: number of the first line in the text.
        last: number of the last line.
        moves: (n,) numbers of the lines that move the robot.
        arms: the lines that arm or disarm the guard.
    """

    first: int
    last: int
    moves: NDArray[np.int64]
    arms: list[Armed]


def _check_stretch(stretch: _Stretch, needed: int, marks: Marks) -> Iterator[Fault]:
    """Check where the guard is armed and disarmed in the lines between two barriers, and that a hold finds
    `needed` moves, or all that are left, among the lines that are ahead.

    The guard must be armed if these lines do not fit into the buffer as a whole.
    """
    moves, arms = stretch.moves, stretch.arms
    count = stretch.last - stretch.first + 1 - len(arms)
    # The whole stretch is in the buffer before the motion starts, so the computer can't be late.
    if count <= marks.full + AHEAD or not len(moves):
        if arms:
            yield (
                f"line {arms[0].line} arms or disarms the guard over {count} lines, which are in the "
                f"buffer as a whole before they start (I17={marks.full}), or have no move"
            )
        return
    first = int(moves[0])
    if not arms or not arms[0].on or arms[0].line > first:
        yield (
            f"the guard isn't armed (P8100=1) before the move in line {first}, after which "
            f"{len(moves) - 1} more moves follow"
        )
        return
    off = [one.line for one in arms[1:]]
    last = int(moves[-1])
    if not off:
        yield (
            f"the guard is armed in line {arms[0].line} and never disarmed: it would hold the motion at its "
            "end"
        )
        return
    if wrong := next((one.line for one in arms[1:] if one.on), None):
        yield f"line {wrong} arms the guard once more"
        return
    if off != list(range(last + 1, last + 1 + len(off))):
        wrong = next(line for number, line in enumerate(off) if line != last + 1 + number)
        yield f"line {wrong} disarms the guard: that belongs directly after the last move (line {last})"
        return
    if stretch.last - last < marks.low + AHEAD:
        yield (
            f"only {stretch.last - last} lines follow the last move in line {last}: with fewer than "
            f"{marks.low + AHEAD} (I16 + {AHEAD}), the guard would hold the motion at its end"
        )
    yield from _check_lines_ahead(stretch, needed, marks)


def _check_lines_ahead(stretch: _Stretch, needed: int, marks: Marks) -> Iterator[Fault]:
    """Check that from each line on, I16 lines contain `needed` moves, or all moves that are left."""
    moves = stretch.moves
    rows = np.arange(len(moves))
    last = np.minimum(rows + needed - 1, len(moves) - 1)
    spans = moves[last] - np.append(stretch.arms[0].line, moves[:-1])
    widest = int(np.argmax(spans))
    if spans[widest] > marks.low:
        yield (
            f"I16={marks.low}: the {last[widest] - widest + 1} moves from line {moves[widest]} on, which a "
            f"late hold can need, are spread over {spans[widest]} lines"
        )


def _stretches(text: ControllerText) -> Iterator[_Stretch]:
    """Yield the lines of each part between two barriers. A barrier's line is the last one of its part."""
    loaded = own_of(text).loaded
    if not loaded:
        return
    end = loaded[-1].first + loaded[-1].text.count("\n")
    barriers = [item.line for item in text.course if isinstance(item, Barred)]
    lines = np.concatenate([run.lines for run in text.runs]) if text.runs else np.empty(0, dtype=np.int64)
    for before, last in pairwise((loaded[0].first - 1, *barriers, end)):
        begin, stop = np.searchsorted(lines, (before, last), side="right")
        arms = [one for one in own_of(text).arms if before < one.line <= last]
        yield _Stretch(before + 1, last, lines[begin:stop], arms)
