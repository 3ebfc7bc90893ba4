"""Resolve the name of a place that is taught at run time."""

from __future__ import annotations

import re

from yarclang.decisions import LONGEST_NAME
from yarclang.diagnostics import Collector
from yarclang.semantics.names.frames import Placed
from yarclang.semantics.names.scope import KINDS, JointPosition, Pose, Scope, Taught
from yarclang.syntax.ast import Value, Word
from yarclang.syntax.words import RESERVED

_NAME = re.compile(r"[A-Z_][A-Z0-9_]*")


def taught_name(value: Value, scope: Scope, statement: Placed, findings: Collector) -> str | None:
    """Return the name under which JPOS or LPOS stores a place; None with a finding if the name is wrong.

    If the program declares the name as a JOINTS or POSE, the declaration keeps its value: the stored value is
    for a person who edits the declaration later. An undeclared name becomes the name of a taught place.
    """
    span = statement.span(value.place)
    if not isinstance(value, Word) or not _NAME.fullmatch(value.name) or value.name in RESERVED:
        findings.add(
            "Y0211", f"`{value.text}` can't be the name of a taught place", span, "for example JPOS FOUND_AT"
        )
        return None
    if len(value.name) > LONGEST_NAME:
        message = f"the name of a place has at most {LONGEST_NAME} characters"
        findings.add("Y0211", message, span, "shorten it")
        return None
    found = scope.name(value.name)
    if found is None:
        scope.declare(value.name, Taught())
    elif not isinstance(found, JointPosition | Pose | Taught):
        message = f"{value.text} is {KINDS[type(found)]}, and can't name a taught place too"
        findings.add("Y0209", message, span, "choose another name")
        return None
    return value.name
