"""Lay out the columns of a table on a terminal: their widths, and abbreviated names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

from yarclang.frozen import frozen

LONGEST_PLACE, SHORTEST_PLACE = 48, 16
"""Largest number of characters of a command's place on a wide terminal, and on a narrow one. On a narrow
terminal, places are cut to the second number before a column is left out.
"""
LEAST_PLACE = 8
"""Smallest number of characters to which places of commands are cut. They are cut so far only to keep the
column with the largest share of a limit.
"""

_LONG_NAME = 4
"""Number of characters of a joint's name above which a narrow table shows joint numbers instead of names."""


@frozen
class Column:
    """A column of a table.

    Attributes:
        name: heading of the column.
        cells: texts from top to bottom.
        side: alignment.
    """

    name: str
    cells: tuple[str, ...]
    side: Literal["left", "right"] = "right"

    @property
    def width(self) -> int:
        """Width of the widest cell or the heading, in characters."""
        return max(len(self.name), *map(len, self.cells))

    def lines(self) -> Iterator[str]:
        """Yield the heading, a rule and the cells, padded to the column's width."""
        width = self.width
        for cell in (self.name, "-" * width, *self.cells):
            yield cell.ljust(width) if self.side == "left" else cell.rjust(width)


def whole_width(columns: Sequence[Column]) -> int:
    """Return the width of a table with all columns, in characters. Places of commands are cut as on a wide
    terminal.
    """
    place, *others = columns
    return min(place.width, LONGEST_PLACE) + sum(column.width + 2 for column in others)


def numbers_of(joints: Sequence[str]) -> dict[str, str]:
    """Return J1, J2, ... as short names, by the joints' names; empty if all names are short anyway, or if a
    joint already has such a name.
    """
    numbers = {name: f"J{number}" for number, name in enumerate(joints, 1)}
    is_worth_it = max(map(len, joints), default=0) > _LONG_NAME and not set(numbers) & set(numbers.values())
    return numbers if is_worth_it else {}


def renamed(column: Column, numbers: Mapping[str, str]) -> Column:
    """Return a column whose joint names are replaced by numbers."""

    def numbered(cell: str) -> str:
        bracket = cell[: cell.startswith("(")]
        name, space, share = cell[len(bracket) :].rpartition(" ")
        return f"{bracket}{numbers[name]}{space}{share}" if name in numbers else cell

    return Column(column.name, tuple(map(numbered, column.cells)), column.side)


def cut(place: str, most: int) -> str:
    """Shorten a place to at most `most` characters, keeping its beginning and its end."""
    if len(place) <= most:
        return place
    end = (most - 3) * 2 // 3
    return f"{place[: most - 3 - end]}...{place[len(place) - end :]}"
