"""Where in unrolled code a command stands: what led to it, from outside in, as `P0020(I=2)>P0010`."""

from __future__ import annotations

from yarclang.syntax.ast import Statement

Place = tuple[str, ...]
"""Commands from outside in. Behind a loop the last part is its count, in brackets, for the command that comes next; behind a CALL it is empty."""


def shown(place: Place) -> str:
    """A place as messages show it."""
    return ">".join(part for part in place if part)


def index_of(statement: Statement) -> str:
    """A command's index; of one without, its line."""
    return f"P{int(statement.index.text[1:]):04d}" if statement.index else f"line {statement.line}"


def looped(place: Place, label: str) -> Place:
    """The place inside a loop: its count goes to the command that comes next."""
    *outer, last = place or ("",)
    inside = f"{last[:-1]},{label})" if last.endswith(")") and last.startswith("(") else f"({label})"
    return (*outer, inside)


def at(place: Place, statement: Statement) -> Place:
    """The place of a command: the loops that it is in stand behind its index."""
    index = index_of(statement)
    if place and (place[-1] == "" or place[-1].startswith("(")):
        return (*place[:-1], index + place[-1])
    return (*place, index)
