"""Find an OUTPUT that is on when the program ends and isn't switched off by a stop."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.findings import Finding
from yarclang.hir import Program, SetOutput
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at


def _look(program: Program, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (rules get two arguments)
    grips = program.cell.grips if program.cell else ()
    kept = {
        one.signal.name for one in program.outputs if one.safe is not None or one.signal.variable in grips
    }
    first: dict[str, SetOutput] = {}
    for step in program.steps:
        if isinstance(step, SetOutput):
            first.setdefault(step.output.name, step)
            if step.value == 0.0:
                kept.add(step.output.name)
    for name, step in first.items():
        if step.value == 1.0 and name not in kept:
            yield remark_at(
                step.origin,
                f"{name} is still ON when the program ends, and a stop doesn't switch it off",
                f"add SET {name} OFF before the end, or declare OUTPUT {name} {step.output.variable} OFF so "
                "that every stop switches it off",
            )


RULE = Rule(
    Finding(
        "Y1020",
        "left-on",
        "warning",
        "an output is switched on, but never off",
        "Glue, a torch or a spindle that isn't switched off stays on at a stop and after the end of the "
        "program. Outputs with a safe value aren't reported, because they get this value at a stop. Outputs "
        "of grippers aren't reported either.",
        "OUTPUT GLUE M1\nP0010 SET GLUE ON\nP0020 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        "OUTPUT GLUE M1 OFF\nP0010 SET GLUE ON\nP0020 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP0030 SET GLUE OFF",
    ),
    Program,
    _look,
    valid=(
        "OUTPUT GLUE M1 OFF\nP0010 SET GLUE ON\nP0020 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        "OUTPUT GLUE M1\nP0010 SET GLUE ON\nP0020 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP0030 SET GLUE OFF",
    ),
    invalid=("OUTPUT GLUE M1\nP0010 SET GLUE ON\nP0020 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",),
)
