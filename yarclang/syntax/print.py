"""Syntax tree to text: names in upper case, one blank between parts, digits and comments as they were."""

from __future__ import annotations

from itertools import groupby

from yarclang.syntax.ast import Module, Statement, Text, Value, WayPoint, Word


def print_module(module: Module) -> str:
    """The whole module as text; parsing it again gives the same statements, moved at most.

    Empty lines are dropped; comment lines stay before the statement that they stood before.
    """
    pieces: list[tuple[int, str]] = [
        (statement.line, print_statement(statement)) for statement in module.statements
    ]
    pieces += module.comment_lines
    return "".join(text + "\n" for _, text in sorted(pieces))


def print_statement(statement: Statement) -> str:
    """One statement; a way-point list keeps its line breaks."""
    parts: list[str] = []
    if statement.index:
        parts.append(statement.index.name)
    parts.append(statement.name.name)
    if statement.moving:
        parts.append(f"{{{statement.moving.name}}}")
    if statement.waypoints:
        parts.append(_waypoints(statement.waypoints))
    if statement.time:
        parts.append(f"[{' '.join(_upper(item) for item in statement.time.items)}]")
    if statement.units:
        parts.append(f"({','.join(item.text.lower() for item in statement.units.items)})")
    if statement.base:
        parts.append(f"{{{statement.base.name}}}")
    for option in statement.options:
        parts.append(option.word.name)
        if option.argument is not None:
            parts.append(_upper(option.argument))
    rows = " ".join(parts).split("\n")
    for comment in statement.comments:
        row = min(comment.place.row, len(rows) - 1)
        rows[row] = f"{rows[row]} {comment.text}"
    return "\n".join(rows)


def _waypoints(waypoints: tuple[WayPoint, ...]) -> str:
    lines = groupby(waypoints, key=lambda waypoint: waypoint.place.row)
    return ";\n".join(
        "; ".join(" ".join(_upper(value) for value in waypoint.values) for waypoint in line)
        for _, line in lines
    )


def _upper(value: object) -> str:
    if isinstance(value, Word):
        return value.name
    assert isinstance(value, Value | Text) or hasattr(value, "text")
    return str(value.text)
