"""Resolve names of frames, in braces, at the place where they are used."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from yarclang.diagnostics import Collector, Edit, Fix
from yarclang.semantics.names.scope import BASE, Frame, Scope
from yarclang.source import Span
from yarclang.subjects import Name, unknown
from yarclang.syntax.ast import FrameName, Place


class Placed(Protocol):
    """Text with a place in a file: a statement, or a single name."""

    def span(self, place: Place) -> Span:
        """Return the span in the file of a part of this text."""


_OLD_NAMES = {"T": "TCP", "TOOL": "TCP", "ROOT": BASE}


def moving_frame(statement: Placed, frame: FrameName, scope: Scope, findings: Collector) -> Frame | None:
    """Return the moving frame of a command; None with a finding if it is unknown or not on the flange."""
    found = known_frame(statement, frame, scope, findings)
    if found is None:
        return None
    if not found.on_flange:
        tools = [name for name in scope.frame_names() if (one := scope.frame(name)) and one.on_flange]
        message = f"{frame.text} is fixed in the cell: it can't be the moving frame"
        help_ = f"write one of {_listed(tools)}"
        findings.add("Y0303", message, statement.span(frame.place), help_, subject=Name(frame.name))
        return None
    return found


def base_axes(
    statement: Placed, frame: FrameName, scope: Scope, may_move: bool, findings: Collector
) -> Frame | None:
    """Return the frame in which a command's values are given; None with a finding if it is wrong.

    Args:
        statement: the line with the frame's name.
        frame: the name.
        scope: the names in scope at this line.
        may_move: True if a frame on the flange is allowed.
        findings: receives the finding.
    """
    found = known_frame(statement, frame, scope, findings)
    if found is not None and found.on_flange and not may_move:
        message = f"{frame.text} moves with the robot: it can't be the base frame of a pose"
        help_ = "write a fixed frame, such as {B}; only DMOVE takes a base frame on the robot"
        findings.add("Y0303", message, statement.span(frame.place), help_, subject=Name(frame.name))
        return None
    return found


def known_frame(statement: Placed, frame: FrameName, scope: Scope, findings: Collector) -> Frame | None:
    """Return the frame with a name; None with a finding if there is none. For an outdated name, the finding
    has a fix with the current one.
    """
    if (found := scope.frame(frame.name)) is not None:
        return found
    span = statement.span(frame.place)
    today = _OLD_NAMES.get(frame.name)
    if today is not None and (found := scope.frame(today)) is not None:
        fix = Fix(f"write {{{today}}}", (Edit(span, f"{{{today}}}"),))
        findings.add("Y0204", f"{frame.text} is now called {{{today}}}", span, f"write {{{today}}}", fix)
        return found
    known = tuple(dict.fromkeys(scope.frame_names()))
    subject = unknown(frame.name, known)
    help_ = f"{subject.question} the frames are {_listed(known)}".lstrip()
    findings.add("Y0301", f"no frame is named {frame.text}", span, help_, subject=subject)
    return None


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"{{{name}}}" for name in names)
