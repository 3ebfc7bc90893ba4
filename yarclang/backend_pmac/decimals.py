"""The number of decimals with which a program is printed."""

from __future__ import annotations

import numpy as np

from yarclang.motion.limits import HEADROOM
from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.kinematics.reach import reach_radii
from yarclang.robot.model import Robot, Tolerance

MOST_DECIMALS = 9
"""Largest number of decimals in a text. The controller's constants have 36 bits of mantissa, so that further
decimals have no effect.
"""

_COUNT_SHARE = 0.25
_PATH_SHARE = 0.05
_SPEED_SHARE = 2e-4


def decimals_for(robot: Robot, segment: float, tolerance: Tolerance, speed: float = np.inf) -> int:
    """Return the smallest number of decimals d of the control points at which rounding does no harm.

    Rounding moves a control point by up to 0.5 * 10^-d. With the segment time h, there are these limits:

    - A motor moves by that distance times the sum of its row of the actuation matrix: at most a quarter of a
      count.
    - The acceleration changes by up to 2 * 10^-d / h^2 and the jerk by up to 4 * 10^-d / h^3: at most the
      headroom of the plan.
    - The roundings of all joints together move the flange by at most 5 % of the tolerance.
    - They change a flange speed that is to be kept by at most 0.02 %.

    Args:
        robot: the robot.
        segment: segment time h [s].
        tolerance: allowed distance from the path.
        speed: flange speed that is to be kept [m/s]; infinite if there is none.
    """
    limits, units = robot.limits, robot.axis_units
    counts = np.abs(counts_per_joint(robot) * units).sum(axis=1).max()
    acceleration = (limits.acceleration / units).min() * HEADROOM["acceleration"]
    jerk = (limits.jerk / units).min() * HEADROOM["jerk"]
    # A joint with an error e moves the flange by at most e times the radius of its reach.
    reach = reach_radii(robot.chain, limits, np.eye(4)) * units
    path = min(
        2.0 * _PATH_SHARE * tolerance.position / reach.sum(),
        2.0 * _PATH_SHARE * tolerance.angle / units.sum(),
    )
    kept = _SPEED_SHARE * speed * segment / reach.sum()
    # `step` is the largest allowed 10^-d; each bound solves one of the docstring's conditions for it.
    step = min(
        path, kept, _COUNT_SHARE / (0.5 * counts), acceleration * segment**2 / 2.0, jerk * segment**3 / 4.0
    )
    return int(np.clip(np.ceil(-np.log10(step) - 1e-9), 1, MOST_DECIMALS))
