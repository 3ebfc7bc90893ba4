"""Find a DMOVE along the base's axes that was probably meant along the tool's axes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.findings import Finding
from yarclang.hir import Array, LineMove, PoseDelta
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.units import DEG

TILTED = 10.0 * DEG
"""If an axis of the tool differs from that of the base by less than this angle [rad], there is no remark:
motions along both are nearly equal.
"""

_ALONG = 2.0 * DEG
"""Largest angle between the previous path and the tool's axis at which the path counts as along this axis
[rad].
"""


def _look(plan: MotionPlan, around: Surroundings) -> Iterator[Remark]:
    said_base = {one.line for one in around.module.statements if one.base is not None}
    before: PlannedMotion | None = None
    for motion in plan.motions:
        step = plan.program.steps[motion.step]
        came, before = before, motion
        if not isinstance(step, LineMove) or not isinstance(step.goal, PoseDelta) or step.goal.axes_on_flange:
            continue
        if step.origin.span.line in said_base or not isinstance(motion.path, CartesianPath):
            continue
        axis = _axis(step.goal)
        if axis is None or came is None or not isinstance(came.path, CartesianPath):
            continue
        rotation = motion.path.frame.poses(np.array([0.0]))[0, :3, :3]
        off = _between(rotation[:, axis], step.goal.axes[:, axis])
        way = came.path.frame.tangents(np.array([1.0]))[0, :3]
        if TILTED < off < np.pi - TILTED and _between(way, rotation[:, axis], both_ways=True) < _ALONG:
            letter = "xyz"[axis]
            base = step.origin.base.name if step.origin.base else "B"
            message = (
                f"this DMOVE goes along {letter} of {{{base}}}, {off / DEG:.0f} deg off the {letter} axis "
                "of the tool, along which the tool came here"
            )
            name = step.origin.moving.name if step.origin.moving else "TCP"
            yield remark_at(
                step.origin,
                message,
                f"write {{{name}}} at the end of the line to move along the tool's axes, or {{{base}}} to "
                "confirm the present ones",
            )


def _axis(goal: PoseDelta) -> int | None:
    """Return the number of the axis along which an increment shifts the frame; None if it shifts along
    several axes, or rotates.
    """
    moves = np.flatnonzero(goal.shift)
    return int(moves[0]) if len(moves) == 1 and np.array_equal(goal.turn, np.eye(3)) else None


def _between(one: Array, other: Array, *, both_ways: bool = False) -> float:
    """Return the angle between two directions [rad].

    Args:
        one: (3,).
        other: (3,).
        both_ways: True for the angle between the lines, up to a right angle.
    """
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    cosine = float(one @ other) / size if size else 0.0
    return float(np.arccos(np.clip(abs(cosine) if both_ways else cosine, -1.0, 1.0)))


_HEAD = "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1074.4 1276 30 0 0\n"
RULE = Rule(
    Finding(
        "Y0308",
        "axes-of-the-tool",
        "warning",
        "a DMOVE moves along base axes, the motion before along tool axes",
        "A tool that entered a hole along its own axis must leave it along the same axis. A DMOVE without "
        "a base frame uses the base frame of DEFAULT: if the tool is tilted, this is a different "
        "direction, and the tool is pulled out sideways.",
        _HEAD + "P0020 DMOVE 0 0 -60 0 0 0 {TCP}\nP0030 DMOVE 0 0 60 0 0 0",
        _HEAD + "P0020 DMOVE 0 0 -60 0 0 0 {TCP}\nP0030 DMOVE 0 0 60 0 0 0 {TCP}",
    ),
    MotionPlan,
    _look,
    valid=(
        _HEAD + "P0020 DMOVE 0 0 -60 0 0 0 {TCP}\nP0030 DMOVE 0 0 60 0 0 0 {TCP}",
        _HEAD + "P0020 DMOVE 0 0 -60 0 0 0 {TCP}\nP0030 DMOVE 0 0 60 0 0 0 {B}",
        (
            "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
            "P0010 MOVEJ_RPY 0 1074.4 1276 0 0 0\n"
            "P0020 DMOVE 0 0 -60 0 0 0 {TCP}\n"
            "P0030 DMOVE 0 0 60 0 0 0"
        ),
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nP0010 MOVEJ 20 0 0 0 -30 0\nP0020 DMOVE 0 0 -120 0 0 0",
    ),
    invalid=(_HEAD + "P0020 DMOVE 0 0 -60 0 0 0 {TCP}\nP0030 DMOVE 0 0 60 0 0 0",),
)
