"""Find an INPUT that is never read."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.findings import Finding
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.syntax.ast import Module


def _look(module: Module, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (rules get two arguments)
    for one in around.names.unused("INPUT"):
        message = f"the input {one.name} is never read in this file"
        yield Remark(
            message,
            one.span,
            f"add WAIT {one.name} ON [30] (s) at the place where the robot should wait, or remove the line",
        )


RULE = Rule(
    Finding(
        "Y1011",
        "unread-input",
        "warning",
        "an INPUT is declared, but never read",
        "An input is declared so that the robot waits for it or branches by it: for example, a door must "
        "be shut, or a part must be present. Without a WAIT or WHEN, the robot goes on at any value of the "
        "input.",
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
