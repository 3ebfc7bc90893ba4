"""Indices of commands: every command has one, each is there once in its file, and they ascend."""

from __future__ import annotations

from yarclang.diagnostics import Collector, Edit, Fix
from yarclang.progress import each
from yarclang.syntax.ast import Module, Statement
from yarclang.syntax.words import DECLARATIONS


def commands_of(module: Module) -> list[Statement]:
    """The commands of a file, in blocks too."""
    return [
        statement
        for statement in each(module.statements)
        if statement.index is not None or statement.name.name not in DECLARATIONS
    ]


def check_indices(commands: list[Statement], findings: Collector) -> None:
    """Every command has an index; each is there once; they ascend."""
    lines: dict[int, int] = {}
    out_of_order: Statement | None = None
    last = -1
    for statement in each(commands):
        if statement.index is None:
            span = statement.span(statement.name.place)
            help_ = "write P0010 (any number that isn't taken) before the name"
            findings.add("Y0105", f"{statement.name.text} has no index", span, help_)
            continue
        number = int(statement.index.text[1:])
        if number in lines:
            span = statement.span(statement.index.place)
            message = f"the index P{number:04d} stands in line {lines[number]} already"
            findings.add("Y0201", message, span, f"P{last + 1:04d} is free")
            continue
        if number < last and out_of_order is None:
            out_of_order = statement
        lines[number] = statement.line
        last = max(last, number)
    if out_of_order is not None and out_of_order.index is not None:
        span = out_of_order.span(out_of_order.index.place)
        edits = tuple(
            Edit(statement.span(statement.index.place), f"P{number:04d}")
            for number, statement in enumerate((one for one in each(commands) if one.index), 1)
            if statement.index
        )
        message = f"the index {out_of_order.index.text} is smaller than one above it"
        findings.add("Y1201", message, span, "renumber the commands", Fix("renumber the commands", edits))
