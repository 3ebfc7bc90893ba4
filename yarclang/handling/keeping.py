"""Find the path constraints (KEEP rules) that apply to each motion of a program."""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.cell.keeping import Keep
from yarclang.decisions import KeptTo
from yarclang.hir import Motion, Program, Step


def keeps_of(step: Step) -> tuple[Keep, ...]:
    """Return the path constraints (KEEP rules) that apply to a step; empty if the step is no motion."""
    return step.keeps if isinstance(step, Motion) else ()


def has_keeps(steps: Sequence[Step]) -> bool:
    """Return True if a path constraint (KEEP rule) applies to any motion."""
    return any(map(keeps_of, steps))


def kept_to(program: Program) -> tuple[KeptTo, ...]:
    """Return the path constraints (KEEP rules) that each motion of a program must satisfy, as listed in the
    comments of a controller text. The rules of the cell come first.
    """
    rules = () if program.cell is None else program.cell.rules
    return tuple(
        KeptTo(number, one.told)
        for number, step in enumerate(program.steps)
        if isinstance(step, Motion)
        for one in dict.fromkeys((*rules, *step.keeps))
    )
