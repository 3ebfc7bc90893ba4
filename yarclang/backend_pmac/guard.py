"""The guard of the rotary buffer, a PLC that holds the motion when too few lines are left: the number of
lines that must be ahead, and the places at which a program arms and disarms the guard.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.program import Assignment, Barrier, Disarm, Item, Moves, Stand
from yarclang.pmac.variables import ARMED
from yarclang.robot.model import Robot

_RESERVE = 0.1
"""Maximum delay with which the guard's PLC notices that too few lines are left [s]."""

_SECONDS_AHEAD = 1.0
"""Smallest size of the rotary buffer, as the duration of the motion whose lines it holds [s]."""

_AHEAD = 2
"""Number of lines that the controller takes out of the buffer before it executes them (TUM 289)."""

_OPENING = 5
"""Number of lines of a text between `CLEAR` and its first TM (`emit.py`)."""

_BEGINNING = 6
"""Number of lines with which a stretch begins before its first move: the text's opening or a `Stand`, and
TM.
"""


@frozen
class Watermarks:
    """Fill levels of the rotary buffer: below `low` lines (I16) it counts as low, from `full` lines (I17) on
    as full. `words` is the size of the buffer.
    """

    low: int
    full: int
    words: int


def watermarks(robot: Robot, segment: float) -> Watermarks:
    """Compute the size of the rotary buffer and its fill levels, for lines that all move the robot.

    A hold consumes moves for half of the hold time, so at least these must be ahead.

    Args:
        robot: the robot.
        segment: segment time [s].
    """
    return _watermarks(robot, segment, _moves_ahead(robot, segment))


def guarded(body: tuple[Item, ...], robot: Robot, segment: float) -> tuple[tuple[Item, ...], Watermarks]:
    """Add the lines that arm and disarm the guard, and compute the fill levels of the buffer.

    At a barrier the buffer runs empty on purpose, so the guard is disarmed before each barrier. The lines
    between two barriers are a stretch. If the buffer has room for a whole stretch, the stretch needs no
    guard, since all its lines are loaded before the motion begins.

    The guard stays armed until after the last move of a stretch, since this computer can fail until all lines
    are loaded. So that the guard doesn't hold the last moves, which have too few lines behind them, the line
    that disarms it is repeated until there are enough.

    The controller counts lines, but only moves take time. So the low mark is the largest number of lines that
    contain the moves of a hold, in any guarded stretch.

    Args:
        body: the program's items after its opening.
        robot: the robot.
        segment: shortest segment time of the program [s].
    """
    moves = _moves_ahead(robot, segment)
    stretches = list(_stretches(body))
    marks = _watermarks(robot, segment, moves)
    # A larger low mark makes the buffer larger, so that fewer stretches need a guard: this ends.
    while (low := _low(stretches, moves, marks)) > marks.low:
        marks = _watermarks(robot, segment, low)
    return tuple(item for one in stretches for item in one.guarded(marks)), marks


@frozen(eq=False)
class _Stretch:
    """The items between two barriers. The first stretch also has the lines of the text's opening.

    Attributes:
        items: the items, the barrier at the end included.
        opening: number of lines before the first item.
        lines: number of lines.
        moves: (n,) the lines that move the robot, counted from 1.
    """

    items: tuple[Item, ...]
    opening: int
    lines: int
    moves: NDArray[np.intp]

    def needs_guard(self, marks: Watermarks) -> bool:
        """Return True if the motion can begin before all lines of this stretch are in the buffer."""
        return len(self.moves) > 0 and self.lines > marks.full + _AHEAD

    def low(self, moves: int) -> int:
        """Return the number of lines in which a hold finds `moves` moves, or all that are left, wherever it
        begins.

        The controller executes all lines before the first move at once. If there are more of them than the
        lines with which any stretch begins, they count too, so that the buffer has room for them and for the
        moves.
        """
        before = np.append(min(self.moves[0] - 1, _BEGINNING), self.moves[:-1])
        last = np.minimum(np.arange(len(self.moves)) + moves - 1, len(self.moves) - 1)
        return int(np.max(self.moves[last] - before))

    def guarded(self, marks: Watermarks) -> Iterator[Item]:
        """Yield the items, with the guard armed before the first move and disarmed after the last one."""
        if not self.needs_guard(marks):
            yield from self.items
            return
        moving = [place for place, item in enumerate(self.items) if isinstance(item, Moves)]
        behind = self.lines - int(self.moves[-1])
        for place, item in enumerate(self.items):
            if place == moving[0]:
                yield Assignment(ARMED, 1)
            yield item
            if place == moving[-1]:
                yield from [Disarm()] * max(marks.low + _AHEAD - behind, 1)


def _stretches(body: tuple[Item, ...]) -> Iterator[_Stretch]:
    """Yield the stretches of a program's body."""
    ends = [place + 1 for place, item in enumerate(body) if isinstance(item, Barrier)]
    begin = 0
    for end in (*ends, len(body)):
        items = body[begin:end]
        opening = 0 if begin else _OPENING
        sizes = np.array([_size(item) for item in items], dtype=np.intp)
        stops = opening + np.cumsum(sizes)
        moving = [place for place, item in enumerate(items) if isinstance(item, Moves)]
        moves = [np.arange(stops[place] - sizes[place], stops[place], dtype=np.intp) + 1 for place in moving]
        lines = int(stops[-1]) if len(items) else opening
        yield _Stretch(items, opening, lines, np.concatenate(moves) if moves else np.empty(0, dtype=np.intp))
        begin = end


def _size(item: Item) -> int:
    """Return the number of lines of an item in a text for a rotary buffer."""
    match item:
        case Moves():
            return len(item.values)
        case Stand():
            return 5
        case _:
            return 1


def _low(stretches: list[_Stretch], moves: int, marks: Watermarks) -> int:
    """Return the low mark that the stretches need that have a guard with the given marks."""
    return max([moves, *(one.low(moves) for one in stretches if one.needs_guard(marks))])


def _moves_ahead(robot: Robot, segment: float) -> int:
    """Return the number of moves that a hold can need, which begins late."""
    return math.ceil((turbo_pmac(robot).hold_time / 2.0 + _RESERVE) / segment)


def _watermarks(robot: Robot, segment: float, low: int) -> Watermarks:
    """Compute the fill levels for a low mark.

    A line takes one word per axis; two more words per line allow for statements between the lines.
    """
    controller = turbo_pmac(robot)
    full = low + max(5, low // 2)
    lines = max(_SECONDS_AHEAD / segment, 2.0 * full)
    words = max(controller.rotary_words, math.ceil(lines * (len(controller.axes) + 2)))
    return Watermarks(low, full, words)
