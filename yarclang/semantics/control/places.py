"""Places of commands in unrolled code: the calls and loops around a command, as `P0020(I=2)>P0010`."""

from __future__ import annotations

from yarclang.syntax.ast import Statement

Place = tuple[str, ...]
"""The calls and loops around a command, from the outermost to the innermost. The last element is to be joined
with the index of the next command: inside a loop it is the value of the loop's counter in brackets, inside a
SUB it is empty.
"""


def shown(place: Place) -> str:
    """Return a place as messages show it."""
    return ">".join(part for part in place if part)


def index_of(statement: Statement) -> str:
    """Return a command's index, or its line if it has none."""
    return f"P{int(statement.index.text[1:]):04d}" if statement.index else f"line {statement.line}"


def looped(place: Place, label: str) -> Place:
    """Return the place inside a loop, from the place of the loop. The next command gets `label`, the loop's
    counter with its value, after its index.
    """
    *outer, last = place or ("",)
    inside = f"{last[:-1]},{label})" if last.endswith(")") and last.startswith("(") else f"({label})"
    return (*outer, inside)


def at(place: Place, statement: Statement) -> Place:
    """Return the place of a command; the counts of the loops around it follow its index."""
    index = index_of(statement)
    if place and (place[-1] == "" or place[-1].startswith("(")):
        return (*place[:-1], index + place[-1])
    return (*place, index)
