"""Find a declared name that is never used."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.diagnostics import Edit, Fix
from yarclang.findings import Finding
from yarclang.lint.names import Declared
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.source import Span
from yarclang.syntax.ast import Module

_KINDS = {
    "FRAME": "frame",
    "JOINTS": "joint position",
    "POSE": "pose",
    "LET": "number",
    "FUNC": "function",
    "TABLE": "table",
    "REGISTER": "register",
    "SUB": "SUB",
    "USE": "module",
}


def _look(module: Module, around: Surroundings) -> Iterator[Remark]:  # noqa: ARG001  (rules get two arguments)
    names = around.names
    # Frames on the flange are reported by unused_tool.py.
    on_flange = set(around.robot.flange_from_frame)
    for declared in names.declared:
        if (
            declared.word == "FRAME"
            and declared.statement.base is not None
            and declared.statement.base.name in on_flange
        ):
            on_flange.add(declared.name)
    for declared in names.unused(*_KINDS):
        if declared.word == "FRAME" and declared.name in on_flange:
            continue
        shown = f"{{{declared.name}}}" if declared.word == "FRAME" else declared.name
        message = f"the {_KINDS[declared.word]} {shown} is never used in this file"
        yield Remark(
            message,
            declared.span,
            "use the name in a command, or remove the line",
            _without(declared),
        )


def _without(one: Declared) -> Fix | None:
    """Return the fix that removes an unused USE line without comments. None for other declarations: their
    author may be about to use the names.
    """
    statement = one.statement
    if one.word != "USE" or statement.comments:
        return None
    line = Span(statement.line, 1, statement.line + statement.rows, 1)
    return Fix(f"remove USE {one.name}", (Edit(line, ""),))


RULE = Rule(
    Finding(
        "Y0216",
        "unused-name",
        "note",
        "a name is declared, but never used",
        "Either the line is a leftover, or a command uses a wrong frame, position or number instead: often "
        "another frame is used twice by mistake. Files without commands aren't checked: they are modules, "
        "whose names are for other files.",
        "FRAME {LEFT} 0 1174.4 1126 0 0 0 (mm,deg) {B}\nFRAME {RIGHT} 200 1074.4 1126 0 0 0 (mm,deg) {B}\n"
        "P0010 MOVEJ_RPY {TCP} 0 0 50 0 0 0 [50%] (mm,deg) {LEFT}",
        "FRAME {LEFT} 0 1174.4 1126 0 0 0 (mm,deg) {B}\n"
        "P0010 MOVEJ_RPY {TCP} 0 0 50 0 0 0 [50%] (mm,deg) {LEFT}",
        needs="use",
        tag="unneeded",
    ),
    Module,
    _look,
    valid=(
        "LET HEIGHT = 1176 (mm)\nP0010 MOVEJ_RPY {TCP} 0 1174.4 $HEIGHT 0 0 0 [5] (mm,deg,s) {B}",
        "JOINTS PARK 0 -10 -40 0 50 0 (deg)\nSTART PARK\nP0010 MOVEJ HOME [MIN]",
        (
            "SUB LIFT A (mm)\n"
            "  P0010 DMOVE {TCP} 0 0 $A 0 0 0 [MIN] (mm,deg) {B}\n"
            "END\n"
            "P0020 MOVEJ 0 0 0 0 -30 0 [MIN] (deg)\n"
            "P0030 CALL LIFT -50"
        ),
    ),
    invalid=(
        "LET HEIGHT = 1176 (mm)\nP0010 MOVEJ HOME [50%]",
        "JOINTS PARK 0 -10 -40 0 50 0 (deg)\nP0010 MOVEJ HOME [50%]",
        "USE PALLET\nP0010 MOVEJ HOME [50%]",
        "SUB AWAY\n  P0010 MOVEJ HOME [MIN]\nEND\nP0020 MOVEJ 0 0 0 0 20 0 [MIN] (deg)",
    ),
)
