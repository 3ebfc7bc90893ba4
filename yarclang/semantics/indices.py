"""Check the indices of commands: every command has an index, each is unique in its file, and they ascend."""

from __future__ import annotations

from yarclang.diagnostics import Collector, Edit, Fix
from yarclang.progress import each
from yarclang.semantics.names.commands import is_command
from yarclang.source import Span
from yarclang.syntax.ast import Module, Statement
from yarclang.syntax.words import DECLARATIONS, LONGEST_INDEX


def commands_of(module: Module) -> list[Statement]:
    """Return the commands of a file, including those in blocks."""
    return [
        statement
        for statement in each(module.statements)
        if statement.index is not None or statement.name.name not in DECLARATIONS
    ]


STEP = 10
"""Difference between two indices; `yarc fmt --renumber` uses the same step."""


def check_indices(commands: list[Statement], findings: Collector) -> None:
    """Check that every command has an index, that each index is unique, and that they ascend."""
    lines: dict[int, int] = {}
    out_of_order: Statement | None = None
    last = -1
    taken = {_number(one) for one in each(commands) if one.index is not None}
    following = _following(commands)
    new = -1
    for place, statement in enumerate(each(commands)):
        before = max(last, new)
        if statement.index is None:
            span = statement.span(statement.name.place)
            new = _free(before, following[place], taken)
            meant = f"P{new:04d}" if new >= 0 else ""
            help_ = f"write {meant or 'P0010 (any number that is free)'} before the name"
            edit = Edit(Span.on_line(span.line, span.column, span.column), f"{meant} ")
            fix = Fix(f"write {meant}", (edit,)) if meant and is_command(statement.name.text) else None
            findings.add("Y0105", f"{statement.name.text} has no index", span, help_, fix)
            continue
        number = _number(statement)
        if number in lines:
            span = statement.span(statement.index.place)
            message = f"the index P{number:04d} is already used in line {lines[number]}"
            findings.add("Y0201", message, span, f"P{last + 1:04d} is free")
            continue
        if number < last and out_of_order is None:
            out_of_order = statement
        lines[number] = statement.line
        last = max(last, number)
    if out_of_order is not None and out_of_order.index is not None:
        span = out_of_order.span(out_of_order.index.place)
        edits = tuple(
            Edit(statement.span(statement.index.place), f"P{number * STEP:04d}")
            for number, statement in enumerate((one for one in each(commands) if one.index), 1)
            if statement.index
        )
        message = f"the index {out_of_order.index.text} is smaller than an index above it"
        findings.add("Y1201", message, span, "renumber the commands", Fix("renumber the commands", edits))


def _number(statement: Statement) -> int:
    assert statement.index is not None  # callers check this first
    return int(statement.index.text[1:])


def _following(commands: list[Statement]) -> list[int]:
    """Return for each command the index of the next command that has one. If no later command has an index,
    return a number above all indices.
    """
    found, following = 10**LONGEST_INDEX, []
    for statement in reversed(commands):
        following.append(found)
        if statement.index is not None:
            found = _number(statement)
    return following[::-1]


def _free(before: int, following: int, taken: set[int]) -> int:
    """Reserve and return an unused index between two others; -1 if there is none.

    Args:
        before: the lower of the two indices.
        following: the higher of the two indices.
        taken: indices in use; the new one is added.
    """
    number = max(before, 0) + STEP
    if number >= following:
        number = max(before, 0) + (following - max(before, 0)) // 2
    if not before < number < following or number in taken:
        return -1
    taken.add(number)
    return number
