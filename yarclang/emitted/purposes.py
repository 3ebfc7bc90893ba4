"""Purposes of the lines of a controller text: the program's command to which a line belongs, and the purpose
in words.
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
    """A command of the program, as the header of a controller text lists it.

    Attributes:
        step: index of the command's step in the program.
        index: the command's index, such as P0010; empty if it has none.
        name: the command's name.
        source_line: line of the command in the source.
        first: the command's first move line in the text; None for a command without moves.
        last: the command's last move line in the text; None for a command without moves.
    """

    step: int
    index: str
    name: str
    source_line: int
    first: int | None
    last: int | None

    @property
    def title(self) -> str:
        """The command's index and name, `P0010 MOVEL`, or its name alone."""
        return f"{self.index} {self.name}" if self.index else self.name


@frozen
class Stretch:
    """Consecutive lines of a controller text that have one purpose.

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
    """Yield the purpose of every line after the header of a controller text, as far as the header shows it.

    Args:
        lines: all lines of the text.
        begin: number of lines in the header.
        commands: the commands as the header lists them.
        barriers: for each line with a barrier (a point at which the program waits for the runtime), the step
            of its command.
    """
    moving = deque(one for one in commands if one.first is not None)
    stepping = {one.step: one for one in commands}
    for number in range(begin + 1, len(lines) + 1):
        while moving and number > (moving[0].last or 0):
            moving.popleft()
        command = moving[0] if moving and number >= (moving[0].first or 0) else None
        barred = stepping.get(barriers[number]) if number in barriers else None
        yield Stretch(number, number, command or barred, MOVE if command else OTHER)
