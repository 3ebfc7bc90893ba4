"""Find an OUTPUT that is never set."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.findings import Finding
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.syntax.ast import Module


def _look(module: Module, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (rules get two arguments)
    for one in around.names.unused("OUTPUT"):
        if sum(len(waypoint.values) for waypoint in one.statement.waypoints) > 2:
            continue  # an output with a safe value is set at a stop
        message = f"the output {one.name} is never set in this file"
        yield Remark(
            message,
            one.span,
            f"add SET {one.name} ON at the place where it should be switched, or remove the line",
        )


RULE = Rule(
    Finding(
        "Y1012",
        "unset-output",
        "warning",
        "an OUTPUT is declared, but never set",
        "A gripper or a valve that is never switched keeps the state of the previous program. An output "
        "with a safe value isn't reported: it gets this value at a stop.",
        "OUTPUT GRIP M1\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        "OUTPUT GRIP M1\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP0020 SET GRIP ON",
        needs="use",
        tag="unneeded",
    ),
    Module,
    _look,
    valid=("OUTPUT GRIP M1\nP0010 SET GRIP ON", "OUTPUT GLUE M1 OFF\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)"),
    invalid=("OUTPUT GRIP M1\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",),
)
