"""Frames: what a name in braces means, in the place where it stands."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from yarclang.diagnostics import Collector, Edit, Fix, suggest
from yarclang.hir import Array
from yarclang.robot.model import Robot
from yarclang.syntax.ast import FrameName, Statement

BASE = "B"
_OLD_NAMES = {"T": "TCP", "TOOL": "TCP", "ROOT": BASE}


@dataclass(frozen=True, slots=True, eq=False)
class Axes:
    """The axes of a base frame: fixed to {B}, or carried by the flange."""

    transform: Array
    """(4, 4): base_from_axes, or flange_from_axes where `on_flange`"""
    on_flange: bool


def moving_frame(statement: Statement, frame: FrameName, robot: Robot, findings: Collector) -> Array | None:
    """The transform flange_from_moving (4, 4) of the frame that a command moves."""
    name = _known(statement, frame, robot, findings)
    if name is None:
        return None
    if name == BASE:
        help_ = f"move one of {_listed(robot.flange_from_frame)}"
        findings.add("Y0303", "{B} stands still: it can't be moved", statement.span(frame.place), help_)
        return None
    return robot.flange_from_frame[name]


def base_axes(
    statement: Statement, frame: FrameName, robot: Robot, may_move: bool, findings: Collector
) -> Axes | None:
    """The axes in which a command's values are given."""
    name = _known(statement, frame, robot, findings)
    if name is None:
        return None
    if name == BASE:
        return Axes(np.eye(4), on_flange=False)
    if not may_move:
        message = f"{{{name}}} moves with the robot: a pose can't be given in it"
        help_ = "write {B}; DMOVE takes a base frame on the robot"
        findings.add("Y0303", message, statement.span(frame.place), help_)
        return None
    return Axes(robot.flange_from_frame[name], on_flange=True)


def check_frame(statement: Statement, frame: FrameName, robot: Robot, findings: Collector) -> bool:
    """Whether the frame is known, wherever it stands; a finding says so if it isn't."""
    return _known(statement, frame, robot, findings) is not None


def _known(statement: Statement, frame: FrameName, robot: Robot, findings: Collector) -> str | None:
    """The frame's name of today, or None and a finding."""
    span = statement.span(frame.place)
    known = (BASE, *robot.flange_from_frame)
    if frame.name in known:
        return frame.name
    today = _OLD_NAMES.get(frame.name)
    if today in known:
        fix = Fix(f"write {{{today}}}", (Edit(span, f"{{{today}}}"),))
        findings.add("Y0204", f"{frame.text} is today {{{today}}}", span, f"write {{{today}}}", fix)
        return today
    meant = suggest(frame.name, known)
    help_ = (meant + " " if meant else "") + f"{robot.name} has the frames {_listed(known)}"
    findings.add("Y0301", f"no frame is named {frame.text}", span, help_)
    return None


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"{{{name}}}" for name in names)
