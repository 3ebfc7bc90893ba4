"""The purpose of each line of a text for a PMAC. This module proves nothing."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from yarclang.emitted.purposes import MOVE, OPENING, Listed, Stretch

_PUT = re.compile(r"(?!P8100=)[IPQM]\d+=.*")
_GUARD = re.compile(r"P8100=(1|P8100&2)")
_SPLINE = "SPLINE1"
_TIME = "the segment time of the moves that follow"
_GUARDS = ("it disarms the guard, after the last move", "it arms the guard")
_AT_REST = "DWELL0"
"""Line at which the robot comes to rest before an output or a barrier. A dwell of the program has another
time.
"""


def purposes(
    lines: Sequence[str], begin: int, commands: Sequence[Listed], barriers: Mapping[int, int]
) -> Iterator[Stretch]:
    """Yield the purpose of every line after the header; see `yarclang.emitted.purposes.moves_alone`.

    An assignment between moves belongs to a SET and a dwell to a WAIT. These lines are recognized by their
    form, and are matched with the SETs and WAITs in order.

    Args:
        lines: lines of the text.
        begin: number of lines in the header.
        commands: commands of the text's map.
        barriers: for each line with a barrier, the step of the barrier's command.
    """
    by_step = {one.step: one for one in commands}
    moving = [one for one in commands if one.first is not None]
    still = [one for one in commands if one.first is None and one.name != "STOP"]
    opened = next((n for n in range(begin + 1, len(lines) + 1) if lines[n - 1] == _SPLINE), len(lines))
    yield from (Stretch(number, number, None, OPENING) for number in range(begin + 1, opened + 1))
    barrier: Listed | None = None
    for number in range(opened + 1, len(lines) + 1):
        line = lines[number - 1]
        while moving and number > (moving[0].last or 0):
            moving.pop(0)
        mover = moving[0] if moving else None
        command: Listed | None = None
        what = "it ends the program"
        if mover is not None and (mover.first or 0) <= number and not _GUARD.fullmatch(line):
            command, what = mover, MOVE
        elif found := _GUARD.fullmatch(line):
            command, what = mover, _GUARDS[found[1] == "1"]
        elif line.startswith("TM"):
            command, what = mover, _TIME
        elif number in barriers:
            command = barrier = by_step.get(barriers[number])
            what = "a barrier: the program doesn't continue by itself"
            while still and command is not None and still[0].step <= command.step:
                still.pop(0)
        elif barrier is not None:
            command, what = (
                barrier,
                "of its barrier, a slow move to the position at which the robot already is",
            )
            if line == _SPLINE:
                barrier = None
        elif line.startswith("DWELL") and still:
            command, what = still[0], "the robot comes to rest before it"
            if line != _AT_REST:
                what = "its dwell"
                still.pop(0)
        elif _PUT.fullmatch(line) and still:
            command, what = still.pop(0), "its assignment"
        yield Stretch(number, number, command, what)
