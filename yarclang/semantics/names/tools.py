"""Resolve the name of a tool that can be changed."""

from __future__ import annotations

from yarclang.cell.tools import NO_TOOL
from yarclang.commands.spec import ToolChange
from yarclang.diagnostics import Collector
from yarclang.semantics.names.frames import Placed
from yarclang.semantics.names.scope import KINDS, RackTool, Scope
from yarclang.subjects import unknown
from yarclang.syntax.ast import Value, Word


def tool_named(value: Value, scope: Scope, statement: Placed, findings: Collector) -> ToolChange | None:
    """Return the tool change that a value names; None with a finding if it names none."""
    found = scope.name(value.name) if isinstance(value, Word) else None
    if isinstance(found, RackTool):
        return ToolChange(found.name, found.lock, found.locks_at)
    known = sorted(set(scope.names(RackTool)))
    if value.text.upper() == NO_TOOL and found is None and known:
        any_of = scope.name(known[0])
        assert isinstance(any_of, RackTool)  # `known` has only names of tools
        return ToolChange("", any_of.lock, 1.0 if any_of.locks_at == 0.0 else 0.0)
    span = statement.span(value.place)
    if found is not None:
        findings.add("Y0209", f"{value.text} is {KINDS[type(found)]}, not a tool", span)
        return None
    subject = unknown(value.text, [*known, NO_TOOL])
    help_ = subject.question or (
        f"there are {', '.join(known)}, and {NO_TOOL}"
        if known
        else "declare it in the cell.toml, under [[tools]], and the changer's output with locks_at"
    )
    what = (
        'name a cell that has tools: CELL "cell.toml"'
        if value.text.upper() == NO_TOOL
        else f"no tool is named {value.text}"
    )
    findings.add("Y0210", what, span, help_, subject=subject)
    return None
