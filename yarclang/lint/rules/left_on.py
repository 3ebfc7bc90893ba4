"""Find an OUTPUT that is on when the program ends and isn't switched off by a stop."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.findings import Finding
from yarclang.hir import Program, SetOutput
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at


def _look(program: Program, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (every rule gets both)
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
                f"write SET {name} OFF when it has done its work, or OUTPUT {name} {step.output.variable} "
                "OFF to have it off at a stop",
            )


RULE = Rule(
    Finding(
        "Y1020",
        "left-on",
        "warning",
        "an output is switched on and never off",
        "Glue, a torch or a spindle that isn't switched off goes on after the program, and after a stop. "
        "Outputs with a safe value aren't reported, since they get this value at a stop; neither are "
        "outputs of grippers.",
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
