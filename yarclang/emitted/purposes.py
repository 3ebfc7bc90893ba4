"""What lines of a controller text are for: the command that they belong to, and a purpose in words."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence

from yarclang.frozen import frozen

OPENING = "it prepares the controller and brings the robot to the start, before the first command"
MOVE = "a move"
OTHER = "of no move"


@frozen
class Listed:
    """A command as the header lists it; `first` and `last` are its move lines, None for one without."""

    step: int
    index: str
    name: str
    source_line: int
    first: int | None
    last: int | None

    @property
    def title(self) -> str:
        """`P0010 MOVEL`, or the name alone."""
        return f"{self.index} {self.name}" if self.index else self.name


@frozen
class Stretch:
    """Neighbouring lines `first` to `last` of the text with one purpose, `what`, and the command that they belong to, if any."""

    first: int
    last: int
    command: Listed | None
    what: str


def moves_alone(
    lines: Sequence[str], begin: int, commands: Sequence[Listed], barriers: Mapping[int, int]
) -> Iterator[Stretch]:
    """Yield the purpose of every line after the header, by what the header lists: moves, and other lines.

    Args:
        lines: of the whole text.
        begin: how many of them are the header.
        commands: as the header lists them.
        barriers: the command's step of each line with a barrier.
    """
    moving = deque(one for one in commands if one.first is not None)
    stepping = {one.step: one for one in commands}
    for number in range(begin + 1, len(lines) + 1):
        while moving and number > (moving[0].last or 0):
            moving.popleft()
        command = moving[0] if moving and number >= (moving[0].first or 0) else None
        barred = stepping.get(barriers[number]) if number in barriers else None
        yield Stretch(number, number, command or barred, MOVE if command else OTHER)
