"""Find an OUTPUT that is never set."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.findings import Finding
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.syntax.ast import Module


def _look(module: Module, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (every rule gets both)
    for one in around.names.unused("OUTPUT"):
        if sum(len(waypoint.values) for waypoint in one.statement.waypoints) > 2:
            continue  # an output with a safe value is set at a stop
        message = f"nothing in this file sets the output {one.name}"
        yield Remark(
            message, one.span, f"write SET {one.name} ON where it should be switched, or remove the line"
        )


RULE = Rule(
    Finding(
        "Y1012",
        "unset-output",
        "warning",
        "an OUTPUT is declared that nothing sets",
        "A gripper or a valve that is never switched stays as the previous program left it. An output "
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
