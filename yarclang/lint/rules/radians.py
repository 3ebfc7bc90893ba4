"""Find joint values in rad in a line whose unit is deg."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.findings import Finding
from yarclang.hir import Array, JointGoal, Motion, Program, TimedMove
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at
from yarclang.units import DEG

_STEP = np.pi / 12.0
"""Angle whose multiples people usually program: 15 degrees [rad]."""

_EXACT = 6e-5
"""Largest difference of a value from a multiple of `_STEP`, if it was written with four digits [rad]."""


def _look(program: Program, around: Surroundings) -> Iterator[Remark]:
    turning = ~around.robot.chain.is_prismatic
    for step in program.steps:
        if not isinstance(step, Motion):
            continue
        for goal in step.waypoints if isinstance(step, TimedMove) else step.goals:
            if isinstance(goal, JointGoal) and (value := _radian(goal.q[turning] / DEG)) is not None:
                turn = round(value / _STEP) * 15
                message = f"{value:.5g} deg looks like {turn} deg in rad; in deg the joint hardly moves"
                yield remark_at(step.origin, message, "write (rad) after the values, or the values in deg")
                break


def _radian(values: Array) -> float | None:
    """Return a joint value that looks like radians: as rad, it is a multiple of 15 deg. None if the values
    are plausible degrees.

    They are plausible if one of them is large or is a round number of degrees.

    Args:
        values: values of the revolute joints [deg].
    """
    if np.abs(values).max(initial=0.0) > 2.0 * np.pi + _EXACT:
        return None
    moving = values[values != 0.0]
    if not len(moving) or (np.abs(moving * 20.0 - np.round(moving * 20.0)) < 1e-9).any():
        return None
    multiples = np.round(moving / _STEP)
    hits = moving[(np.abs(moving - multiples * _STEP) < _EXACT) & (multiples != 0)]
    return float(hits[0]) if len(hits) >= min(2, len(moving)) else None


RULE = Rule(
    Finding(
        "Y0418",
        "radians",
        "warning",
        "joint values in degrees look like radians",
        "1.5708 is an unusual angle in deg, and a quarter of a turn in rad. The line can be carried out, "
        "but the joint moves only by a sixtieth of the intended angle, and the next straight motion starts "
        "from a wrong place.",
        "P0010 MOVEJ 1.5708 0 0 0 0.5236 0 [5] (deg,s)",
        "P0010 MOVEJ 1.5708 0 0 0 0.5236 0 [5] (rad,s)",
    ),
    Program,
    _look,
    valid=(
        "P0010 MOVEJ 1.5708 0 0 0 0.5236 0 [5] (rad,s)",
        "P0010 MOVEJ 1.57 0 0 0 5 0 [5] (deg,s)",
        "P0010 MOVEJ 0.123 0.2618 1.413 0 0 0 [5] (deg,s)",
    ),
    invalid=("P0010 MOVEJ 1.5708 0 0 0 0.5236 0 [5] (deg,s)", "P0010 MOVEJ 0 0 0 0 -0.7854 0 [5] (deg,s)"),
)
