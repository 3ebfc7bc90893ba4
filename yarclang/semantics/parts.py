"""Refuse syntax that a statement doesn't accept, such as a frame or a motion time."""

from __future__ import annotations

from collections.abc import Container

from yarclang.diagnostics import Collector
from yarclang.syntax.ast import Place, Statement

NOT_FOR_BLOCKS = ("a moving frame", "a motion time", "units", "a base frame", "options")
"""Parts that the first lines of blocks, and CALL, don't accept."""

ALL_PARTS = ("a moving frame", "values", "a motion time", "units", "a base frame", "options")


def refuse_parts(statement: Statement, refused: Container[str], findings: Collector) -> None:
    """Add a finding if a statement has syntax that it doesn't accept, such as a frame or a motion time. Only
    the first such part of the statement is reported.

    Args:
        statement: the line.
        refused: the parts that the statement doesn't accept, by their names in ALL_PARTS.
        findings: receives the finding.
    """
    places: list[tuple[str, Place]] = []
    if statement.moving:
        places.append(("a moving frame", statement.moving.place))
    if statement.waypoints:
        places.append(("values", statement.waypoints[0].place))
    if statement.time:
        places.append(("a motion time", statement.time.place))
    if statement.units:
        places.append(("units", statement.units.place))
    if statement.base:
        places.append(("a base frame", statement.base.place))
    if statement.options:
        places.append(("options", statement.options[0].word.place))
    for part, place in places:
        if part in refused:
            message = f"{statement.name.name} doesn't take {part}"
            findings.add("Y0408", message, statement.span(place), "remove it")
            return
