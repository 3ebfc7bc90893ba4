"""Purposes of the lines of a controller text: the command to which a line belongs, and the purpose in
words.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence

from yarclang.frozen import frozen

OPENING = "it prepares the controller and brings the robot to the start, before the first command"
MOVE = "a move"
OTHER = "of no move"


@frozen
class Listed:
    """A command as the header lists it.

    Attributes:
        step: index of the step in the program.
        index: the command's index; empty without one.
        name: the command's name.
        source_line: line in the source.
        first: first move line in the text; None for a command without moves.
        last: last move line in the text; None for a command without moves.
    """

    step: int
    index: str
    name: str
    source_line: int
    first: int | None
    last: int | None

    @property
    def title(self) -> str:
        """The index and the name, `P0010 MOVEL`, or the name alone."""
        return f"{self.index} {self.name}" if self.index else self.name


@frozen
class Stretch:
    """Consecutive lines of the text with one purpose.

    Attributes:
        first: number of the first line.
        last: number of the last line.
        command: the command to which the lines belong, if any.
        what: the purpose in words.
    """

    first: int
    last: int
    command: Listed | None
    what: str


def moves_alone(
    lines: Sequence[str], begin: int, commands: Sequence[Listed], barriers: Mapping[int, int]
) -> Iterator[Stretch]:
    """Yield the purpose of every line after the header, if the header shows it.

    Args:
        lines: all lines of the text.
        begin: number of lines in the header.
        commands: the commands as the header lists them.
        barriers: the step of the command of each line with a barrier.
    """
    moving = deque(one for one in commands if one.first is not None)
    stepping = {one.step: one for one in commands}
    for number in range(begin + 1, len(lines) + 1):
        while moving and number > (moving[0].last or 0):
            moving.popleft()
        command = moving[0] if moving and number >= (moving[0].first or 0) else None
        barred = stepping.get(barriers[number]) if number in barriers else None
        yield Stretch(number, number, command or barred, MOVE if command else OTHER)
