"""Find a tool that no command uses."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.findings import Finding
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.syntax.ast import Module


def _look(module: Module, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (rules get two arguments)
    names = around.names
    on_flange = set(around.robot.flange_from_frame)
    for declared in names.declared:
        if (
            declared.word == "FRAME"
            and declared.statement.base is not None
            and declared.statement.base.name in on_flange
        ):
            on_flange.add(declared.name)
    for declared in names.unused("FRAME"):
        if declared.name in on_flange:
            message = f"the tool {{{declared.name}}} is never used in this file"
            yield Remark(
                message,
                declared.span,
                f"write {{{declared.name}}} in DEFAULT or in the commands that move it, or remove the line",
            )


RULE = Rule(
    Finding(
        "Y0215",
        "unused-tool",
        "warning",
        "a tool is declared, but never used",
        "A declared tool is mounted on the robot. If no command uses it, all commands move another frame, "
        "most likely {TCP}, to the tool's places, where the tool may collide.",
        "FRAME {TORCH} 0 100 35 0 45 0 (mm,deg) {FLANGE}\n"
        "P0010 MOVEJ_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "FRAME {TORCH} 0 100 35 0 45 0 (mm,deg) {FLANGE}\n"
        "P0010 MOVEJ_RPY {TORCH} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        needs="use",
        tag="unneeded",
    ),
    Module,
    _look,
    valid=(
        (
            "FRAME {TORCH} 0 0 50 0 0 0 (mm,deg) {FLANGE}\n"
            "DEFAULT {TORCH} [5] (mm,deg,s) {B}\n"
            "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0"
        ),
        (
            "FRAME {MOUNT} 0 0 50 0 0 0 (mm,deg) {FLANGE}\nFRAME {TIP} 0 0 50 0 0 0 (mm,deg) {MOUNT}\n"
            "P0010 MOVEJ_RPY {TIP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}"
        ),
        "FRAME {TABLE} 0 900 500 0 0 0 (mm,deg) {B}\nP0010 MOVEJ HOME [50%]",
    ),
    invalid=(
        (
            "FRAME {TORCH} 0 0 50 0 0 0 (mm,deg) {FLANGE}\n"
            "P0010 MOVEJ_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}"
        ),
        (
            "FRAME {MOUNT} 0 0 50 0 0 0 (mm,deg) {FLANGE}\nFRAME {TIP} 0 0 50 0 0 0 (mm,deg) {MOUNT}\n"
            "P0010 MOVEJ_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}"
        ),
    ),
)
