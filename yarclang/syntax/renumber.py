"""Renumber the commands of a file."""

from __future__ import annotations

from dataclasses import replace

from yarclang.syntax.ast import Module, Statement, Word
from yarclang.syntax.words import DECLARATIONS


def renumbered(module: Module, start: int, step: int) -> Module:
    """Return a file's syntax tree with ascending indices for its commands. A command without an index gets
    one.
    """
    number = start
    statements: list[Statement] = []
    for one in module.statements:
        if one.index is None and one.name.name in DECLARATIONS:
            statements.append(one)
            continue
        place = one.index.place if one.index else one.name.place
        statements.append(replace(one, index=Word(f"P{number:04d}", place)))
        number += step
    return replace(module, statements=tuple(statements))
