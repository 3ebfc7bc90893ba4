"""Find motions faster than the reduced speed for people nearby."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.findings import Finding
from yarclang.hir import Array, Motion
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.robot.kinematics.fk import poses_and_jacobians
from yarclang.robot.model import Robot
from yarclang.units import MM

LARGEST = 250.0 * MM
"""The reduced speed of ISO 10218-1, 5.6.2 [m/s]."""

_ROUNDING = 1e-3
"""Allowed excess over `LARGEST`, as a share of it. The planner rounds a speed such as [V 250]."""


def _look(plan: MotionPlan, around: Surroundings) -> Iterator[Remark]:
    if not around.teach:
        return
    for motion in plan.motions:
        step = plan.program.steps[motion.step]
        assert isinstance(step, Motion)
        speed = _speed(around.robot, motion)
        if speed <= LARGEST * (1.0 + _ROUNDING):
            continue
        message = (
            f"the tool goes at up to {speed / MM:.0f} mm/s; with teach = true in yarc.toml "
            f"{LARGEST / MM:.0f} is the limit"
        )
        needed = motion.curve.duration * speed / LARGEST
        yield remark_at(
            step.origin,
            message,
            f"give the motion about {needed:.2g} s, or [V<={LARGEST / MM:.0f}] with mm and s",
        )


def _speed(robot: Robot, motion: PlannedMotion) -> float:
    """Return the largest sampled speed [m/s] of the moving frame's origin; for joint motions, that of
    {TCP}.
    """
    path = motion.path
    frame: Array = robot.flange_from_frame.get("TCP", np.eye(4))
    if isinstance(path, CartesianPath):
        frame = path.flange_from_moving
    segments = max(1, round(motion.curve.duration / motion.curve.segment))
    q, v, _ = motion.curve.sample(np.linspace(0.0, motion.curve.duration, 4 * segments + 1))
    _, jacobians = poses_and_jacobians(robot.chain, q, frame)
    return float(np.linalg.norm(np.einsum("Nij,Nj->Ni", jacobians[:, :3], v), axis=1).max())


RULE = Rule(
    Finding(
        "Y0613",
        "above-teach-speed",
        "warning",
        "the tool moves faster than 250 mm/s in a teaching program",
        "While a person is within reach, the tool may move at 250 mm/s at most: the reduced speed of ISO "
        "10218-1. `teach = true` in yarc.toml states that the programs are used in this way. This check "
        "isn't a safety function: the controller's own speed monitoring is needed as well.",
        "P0010 MOVEJ 90 0 0 0 0 0 [MIN] (deg)",
        "P0010 MOVEJ 90 0 0 0 0 0 [20] (deg,s)",
    ),
    MotionPlan,
    _look,
    valid=(
        "P0010 MOVEJ 90 0 0 0 0 0 [20] (deg,s)",
        (
            "DEFAULT {TCP} (mm,deg,s) {B}\n"
            "P0010 MOVEJ_RPY 0 1174.4 1376 0 0 0 [10]\n"
            "P0020 MOVEL 0 1174.4 1076 0 0 0 [V 250]"
        ),
    ),
    invalid=(
        "P0010 MOVEJ 90 0 0 0 0 0 [MIN] (deg)",
        (
            "DEFAULT {TCP} (mm,deg,s) {B}\n"
            "P0010 MOVEJ_RPY 0 1174.4 1376 0 0 0 [10]\n"
            "P0020 MOVEL 0 1174.4 1076 0 0 0 [V 260]"
        ),
    ),
    teach=True,
)
