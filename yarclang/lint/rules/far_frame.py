"""Find a frame far out of the arm's reach."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.findings import Finding
from yarclang.hir import Array, FrameLink, Motion, Program
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.model import Robot
from yarclang.units import MM

FAR = 2.0
"""Distance of a frame from {B} above which there is a remark, as a multiple of the arm's length."""


def _look(program: Program, around: Surroundings) -> Iterator[Remark]:
    length = _length(around.robot)
    seen: set[int] = set()
    for step in program.steps:
        if not isinstance(step, Motion):
            continue
        for link, most in ((step.origin.base, FAR * length), (step.origin.moving, length)):
            if link is None or link.span is None or id(link) in seen:
                continue
            seen.add(id(link))
            away = float(np.linalg.norm(_placed(link)[:3, 3]))
            if away <= most:
                continue
            where = "{FLANGE}" if link is step.origin.moving else "{B}"
            message = (
                f"{{{link.name}}} is {away / MM:,.0f} mm away from {where}; the arm is {length / MM:,.0f} "
                "mm long"
            )
            yield Remark(
                message, link.span, "correct the values, their units or the parent frame", None, link.source
            )


def _placed(link: FrameLink) -> Array:
    """Return the pose (4, 4) of a frame in {B} or {FLANGE}."""
    pose = link.parent_from_frame
    above = link.parent
    while above is not None:
        pose, above = above.parent_from_frame @ pose, above.parent
    return pose


def _length(robot: Robot) -> float:
    """Return the largest possible distance of the flange from the first joint axis [m], with all prismatic
    joints extended.
    """
    limits = robot.limits
    travel = np.maximum(np.abs(limits.lower), np.abs(limits.upper))[robot.chain.is_prismatic]
    return arm_length(robot.chain, np.eye(4)) + float(travel.sum())


RULE = Rule(
    Finding(
        "Y0309",
        "far-frame",
        "warning",
        "a frame is far outside the robot's reach",
        "If a table is twice as far away as the arm is long, or a tool is longer than the arm, most likely "
        "a value is in the wrong unit, or the parent frame isn't the one in which the frame was measured. "
        "If poses in this frame are refused, this is most likely the reason.",
        "FRAME {TABLE} 0 1000 500 0 0 0 (cm,deg) {B}\n"
        "P0010 MOVEJ_RPY {TCP} 0 -900 0 0 0 0 [5] (cm,deg,s) {TABLE}",
        "FRAME {TABLE} 0 1074.4 900 0 0 0 (mm,deg) {B}\n"
        "P0010 MOVEJ_RPY {TCP} 0 0 276 0 0 0 [5] (mm,deg,s) {TABLE}",
        needs="unit",
    ),
    Program,
    _look,
    valid=(
        (
            "FRAME {TABLE} 0 1074.4 900 0 0 0 (mm,deg) {B}\n"
            "P0010 MOVEJ_RPY {TCP} 0 0 276 0 0 0 [5] (mm,deg,s) {TABLE}"
        ),
        (
            "FRAME {TORCH} 0 0 0.2 0 0 0 (m,deg) {FLANGE}\n"
            "P0010 MOVEJ_RPY {TORCH} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}"
        ),
    ),
    invalid=(
        (
            "FRAME {CELL} 0 9000 0 0 0 0 (mm,deg) {B}\n"
            "P0010 MOVEJ_RPY {TCP} 0 -7800 1100 0 0 0 [5] (mm,deg,s) {CELL}"
        ),
        (
            "FRAME {TORCH} 0 0 200 0 0 0 (m,deg) {FLANGE}\n"
            "P0010 MOVEJ_RPY {TORCH} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}"
        ),
    ),
    explains_errors=True,
)
