"""How many decimals a program is printed with."""

from __future__ import annotations

import numpy as np

from yarclang.motion.limits import HEADROOM
from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.kinematics.reach import reach_radii
from yarclang.robot.model import Robot, Tolerance

MOST_DECIMALS = 9
"""The controller's constants have 36 bits of mantissa: more decimals than these are noise."""

_COUNT_SHARE = 0.25
_PATH_SHARE = 0.05
_SPEED_SHARE = 2e-4


def decimals_for(robot: Robot, segment: float, tolerance: Tolerance, speed: float = np.inf) -> int:
    """The fewest decimals at which rounding does no harm with segments of `segment` [s].

    A control point is off by up to 0.5 * 10^-d: each motor by that times its row of the actuation matrix (at
    most a quarter of a count), the acceleration by up to 2 * 10^-d / h^2 and the jerk by up to 4 * 10^-d / h^3, which
    has to fit into the headroom of the plan. The joints' roundings together move the flange by at most 5 % of the
    tolerance, and change a `speed` of the flange that is to be kept [m/s] by at most 0.02 %.
    """
    limits, units = robot.limits, robot.axis_units
    counts = np.abs(counts_per_joint(robot) * units).sum(axis=1).max()
    acceleration = (limits.acceleration / units).min() * HEADROOM["acceleration"]
    jerk = (limits.jerk / units).min() * HEADROOM["jerk"]
    reach = reach_radii(robot.chain, limits, np.eye(4)) * units
    path = min(
        2.0 * _PATH_SHARE * tolerance.position / reach.sum(),
        2.0 * _PATH_SHARE * tolerance.angle / units.sum(),
    )
    kept = _SPEED_SHARE * speed * segment / reach.sum()
    step = min(
        path, kept, _COUNT_SHARE / (0.5 * counts), acceleration * segment**2 / 2.0, jerk * segment**3 / 4.0
    )
    return int(np.clip(np.ceil(-np.log10(step) - 1e-9), 1, MOST_DECIMALS))
