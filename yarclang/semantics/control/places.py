"""Places of commands in unrolled code: the calls and loops around a command, as `P0020(I=2)>P0010`."""

from __future__ import annotations

from yarclang.syntax.ast import Statement

Place = tuple[str, ...]
"""The calls and loops around a command, from the outermost to the innermost.

In the place of a block, the last element is a suffix for the indices of the commands in the block: `(I=2)` in
a loop, empty in a SUB. The place of a command ends with its index and this suffix. For the CALL P0020 in a
loop, `("(I=2)",)` is the place of the loop's body, `("P0020(I=2)",)` that of the CALL, and
`("P0020(I=2)", "")` that of the SUB's body.
"""


def shown(place: Place) -> str:
    """Return a place as messages show it."""
    return ">".join(part for part in place if part)


def index_of(statement: Statement) -> str:
    """Return a command's index, or its line if it has none."""
    return f"P{int(statement.index.text[1:]):04d}" if statement.index else f"line {statement.line}"


def looped(place: Place, label: str) -> Place:
    """Return the place inside a loop.

    Args:
        place: the place of the block that contains the loop.
        label: the loop's counter with its value, such as `I=2`.
    """
    *outer, last = place or ("",)
    inside = f"{last[:-1]},{label})" if last.endswith(")") and last.startswith("(") else f"({label})"
    return (*outer, inside)


def at(place: Place, statement: Statement) -> Place:
    """Return the place of a command in a block: the block's place, with the command's index before the counts
    of the loops. In a block `(I=2)`, command P0010 has the place `P0010(I=2)`.
    """
    index = index_of(statement)
    if place and (place[-1] == "" or place[-1].startswith("(")):
        return (*place[:-1], index + place[-1])
    return (*place, index)
