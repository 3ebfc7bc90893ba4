"""Comparison of the program that was planned with the program that was asked for.

The planner replaces a line around obstacles (`LineMove.avoids`) by several straight lines, its legs, and the
judge compares the controller text with these. The planner is free to choose the corners between the legs:
each leg is proved like any other line. The last leg must end at the line's goal, and the legs must have the
line's options and its total duration. This is checked here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from yarclang.diagnostics import Diagnostic
from yarclang.hir import Gap, LineMove, PoseGoal, Program, Step
from yarclang.robot.model import Array

_EXACT = 1e-9
"""Allowed rounding error of a rotation matrix, and of the sum of durations [s]."""


def strayed(asked: Program, planned: Program) -> Diagnostic | None:
    """Return a finding if a planned program isn't the one that was asked for, else None.

    Args:
        asked: the program as it was checked.
        planned: the program in which lines around obstacles are replaced by their straight legs.
    """
    if planned is asked:
        return None
    same = replace(planned, steps=asked.steps)
    for one in fields(Program):
        if getattr(same, one.name) is not getattr(asked, one.name):
            return _finding(
                f"{one.name} of the program differ", asked.steps[0] if asked.steps else Gap(), asked
            )
    at = 0
    for step in asked.steps:
        if not (isinstance(step, LineMove) and step.avoids):
            if at >= len(planned.steps) or planned.steps[at] is not step:
                return _finding("another command is in its place", step, asked)
            at += 1
            continue
        legs = list[Step]()
        while at < len(planned.steps):
            leg = planned.steps[at]
            legs.append(leg)
            at += 1
            if isinstance(leg, LineMove) and leg.goal is step.goal:
                break
        if fault := _fault(step, legs):
            return _finding(fault, step, asked)
    if at < len(planned.steps):
        return _finding("more commands follow", asked.steps[-1], asked)
    return None


def _fault(step: LineMove, legs: Sequence[Step]) -> str:
    """Return the fault of the legs that replace a line, in words; empty if there is none."""
    last = legs[-1] if legs else None
    if not isinstance(last, LineMove) or last.goal is not step.goal:
        return "its legs don't end at its goal"
    total = 0.0
    for leg in legs:
        if not isinstance(leg, LineMove) or leg.avoids or leg.origin is not step.origin:
            return "it is replaced by steps that aren't straight legs"
        duration = leg.timing.duration
        if (duration is None) != (step.timing.duration is None) or (duration is not None and duration <= 0.0):
            return "its legs have other times"
        total += duration or 0.0
        timing = replace(leg.timing, duration=step.timing.duration)
        kept = leg.profile, timing, leg.tolerance, leg.allowed, leg.keeps
        if kept != (step.profile, step.timing, step.tolerance, step.allowed, step.keeps):
            return "its legs have other options"
        if leg is last:
            if leg.blend != step.blend or leg.search != step.search:
                return "its last leg doesn't end as the command does"
        elif leg.search is not None or leg.blend is not None or not _is_pose(leg.goal, step.goal):
            return "a leg doesn't end at rest in a pose of its frame"
    if step.timing.duration is not None and abs(total - step.timing.duration) > _EXACT:
        return f"its legs take {total:.6g} s instead of {step.timing.duration:.6g} s"
    return ""


def _is_pose(goal: object, asked: object) -> bool:
    """Return True if a goal is a rigid pose of the same moving frame as `asked`, and has no NEAR, no shift by
    registers and no numbers from the source.
    """
    if not isinstance(goal, PoseGoal) or not isinstance(asked, PoseGoal):
        return False
    if goal.near is not None or goal.told is not None or goal.shifted:
        return False
    return goal.flange_from_moving is asked.flange_from_moving and _is_rigid(goal.base_from_moving)


def _is_rigid(pose: Array) -> bool:
    # A rotation matrix is orthogonal and has the determinant 1.
    turn = pose[:3, :3]
    return bool(
        pose.shape == (4, 4)
        and np.isfinite(pose).all()
        and (pose[3] == [0.0, 0.0, 0.0, 1.0]).all()
        and np.abs(turn @ turn.T - np.eye(3)).max() < _EXACT
        and np.linalg.det(turn) > 0.0
    )


def _finding(message: str, step: Step, asked: Program) -> Diagnostic:
    if isinstance(step, Gap):
        return Diagnostic("Y0964", message, asked.source)
    origin = step.origin
    return Diagnostic("Y0964", message, origin.source, origin.span, place=origin.place)
