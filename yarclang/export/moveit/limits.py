"""Limits of motors that MoveIt can't know, since they are none of one joint."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.diagnostics import Diagnostic
from yarclang.robot.model import Robot

_SLACK = 1e-9


def check_motors(robot: Robot) -> Iterator[Diagnostic]:
    """Yield a warning for each motor that reaches its speed limit before the joints that turn it reach theirs."""
    actuation = robot.actuation
    speeds = robot.limits.velocity / robot.axis_units
    turns = np.abs(actuation.gear[:, None] * actuation.coupling)
    need = turns @ speeds
    for row in np.flatnonzero(need > actuation.velocity * (1.0 + _SLACK)):
        joints = [robot.joint_names[at] for at in np.flatnonzero(turns[row])]
        share = 100.0 * actuation.velocity[row] / need[row]
        together = "together " if len(joints) > 1 else ""
        message = (
            f"motor {robot.controller.motors[row]} allows {', '.join(joints)} {together}only {share:.1f} % of their speed "
            "limits, which MoveIt can't know"
        )
        help_ = f"let MoveIt plan at most at {share:.0f} % (max_velocity_scaling_factor), or let yarc refuse what is too fast"
        yield Diagnostic("Y1535", message, help=help_)
