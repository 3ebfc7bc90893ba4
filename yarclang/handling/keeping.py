"""Find the rules (KEEP) to which each motion of a program keeps."""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.cell.keeping import Keep
from yarclang.decisions import KeptTo
from yarclang.hir import Motion, Program, Step


def keeps_of(step: Step) -> tuple[Keep, ...]:
    """Return the rules to which a step keeps; none if it is no motion."""
    return step.keeps if isinstance(step, Motion) else ()


def has_keeps(steps: Sequence[Step]) -> bool:
    """Return True if any motion keeps to a rule."""
    return any(map(keeps_of, steps))


def kept_to(program: Program) -> tuple[KeptTo, ...]:
    """Return the rules of all motions of a program, as the map of a controller text states them: those of its
    cell first.
    """
    rules = () if program.cell is None else program.cell.rules
    return tuple(
        KeptTo(number, one.told)
        for number, step in enumerate(program.steps)
        if isinstance(step, Motion)
        for one in dict.fromkeys((*rules, *step.keeps))
    )
