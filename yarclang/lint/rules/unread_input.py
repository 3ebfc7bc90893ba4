"""Find an INPUT that is never read."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.findings import Finding
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.syntax.ast import Module


def _look(module: Module, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (every rule gets both)
    for one in around.names.unused("INPUT"):
        message = f"nothing in this file reads the input {one.name}"
        yield Remark(
            message,
            one.span,
            f"write WAIT {one.name} ON [30] (s) where the robot should wait for it, or remove the line",
        )


RULE = Rule(
    Finding(
        "Y1011",
        "unread-input",
        "warning",
        "an INPUT is declared that nothing reads",
        "An input is declared so that the robot waits for it, or chooses a way by it: for example, a "
        "door must be shut, or a part must be there. Without a WAIT or WHEN the robot goes on whatever "
        "the value of the input is.",
        "INPUT DOOR_SHUT M11\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        "INPUT DOOR_SHUT M11\nP0010 WAIT DOOR_SHUT ON [30] (s)\nP0020 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        needs="use",
        tag="unneeded",
    ),
    Module,
    _look,
    valid=(
        "INPUT DOOR M11\nP0010 WAIT DOOR ON [30] (s)",
        'INPUT DOOR M11\nWHEN DOOR OFF\n  P0010 HOLD "shut the door"\nEND',
        "INPUT DOOR M11\nSUB READY WHAT\n  P0010 WAIT WHAT ON [30] (s)\nEND\nP0020 CALL READY DOOR",
    ),
    invalid=("INPUT DOOR M11\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",),
)
