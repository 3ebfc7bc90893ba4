"""Conversion of a goal (a trajectory from ROS) to a program with one timed motion. The coordinator plans and
proves it like any other program. No I/O.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array, Robot
from yarclang.ros.motion import Goal

START_WITHIN = 0.01
"""Largest distance between the robot and a goal's first way-point at which this way-point counts as the
robot's own position [rad or m], as in MoveIt's check.
"""

LEAD_SHARE = 0.5
"""Largest share of the velocity and acceleration limits for the motion to a goal's first way-point, if the
robot isn't there yet.
"""

_SHORTEST_LEAD = 0.1
"""Shortest duration of the motion to the first way-point [s]."""

_SINGLE = 1e-6
"""Largest excess of a joint position over a limit that counts as rounding to single precision, relative to
the limit (at least 1 rad or 1 m).
"""

_NEXT = ";\n      "
"""Separator of way-points. Each way-point is on a line of its own, because the length of lines is limited."""

_SAME = 1e-6
"""Largest distance between the robot and a goal's only way-point at which no motion is needed [rad or m]."""


def timetable(robot: Robot, goal: Goal, stands: Array) -> tuple[Array, Array]:
    """Return the way-points of a goal and the times from its start to each of them.

    The duration of the first way-point isn't used, because ROS-Industrial's client node computes it from the
    previous trajectory. If the robot is at the first way-point, this way-point is left out. Otherwise its
    time is computed from the distance and the limits. Velocity ratios aren't used either, because different
    motions have the same ratios.

    Args:
        robot: robot whose joints the goal names, in the order of robot.toml.
        goal: goal as received.
        stands: (n,) commanded position of the robot [rad or m].

    Returns:
        (k, n) positions [rad or m] and (k,) times [s]. k is 0 if the robot need not move.
    """
    positions = _within(robot, np.array([one.joints[: robot.size] for one in goal.points], dtype=float))
    durations = np.array([one.duration for one in goal.points], dtype=float)
    away = np.abs(positions[0] - stands)
    if len(positions) > 1 and float(away.max()) <= START_WITHIN:
        positions, durations = positions[1:], durations[1:]
    elif len(positions) == 1 and float(away.max()) <= _SAME:
        return np.empty((0, robot.size)), np.empty(0)
    else:
        durations[0] = _lead(robot, away)
    return positions, np.cumsum(durations)


def goal_text(robot: Robot, positions: Array, times: Array) -> str:
    """Return the program that moves through way-points at given times.

    Args:
        robot: robot that runs the program.
        positions: (k, n) way-points with k >= 1 [rad or m].
        times: (k,) times since the start [s], increasing.
    """
    rows = (positions / robot.axis_units).tolist()
    points = (
        f"{' '.join(f'{value:.8f}' for value in row)} [{time:.6f}]"
        for row, time in zip(rows, times.tolist(), strict=True)
    )
    return f"P0010 MOVEJ_TIMED {_NEXT.join(points)} (mm,deg,s)\n"


def _within(robot: Robot, positions: Array) -> Array:
    """Clamp joint positions (k, n) to the robot's limits where they exceed a limit only by rounding to single
    precision. Return all positions.
    """
    limits = robot.limits
    lower = limits.lower - _SINGLE * np.maximum(np.abs(limits.lower), 1.0)
    upper = limits.upper + _SINGLE * np.maximum(np.abs(limits.upper), 1.0)
    at_limit = np.clip(positions, limits.lower, limits.upper)
    found: Array = np.where((positions >= lower) & (positions <= upper), at_limit, positions)
    return found


def _lead(robot: Robot, away: Array) -> float:
    """Return the duration of the motion to the first way-point [s]: of a polynomial of degree five from rest
    to rest over the distance d. Its peak velocity is 1.875 d/T and its peak acceleration 5.774 d/T².
    """
    limits = robot.limits
    by_velocity = 1.875 * away / (LEAD_SHARE * limits.velocity)
    by_acceleration = np.sqrt(5.774 * away / (LEAD_SHARE * limits.acceleration))
    return max(_SHORTEST_LEAD, float(by_velocity.max()), float(by_acceleration.max()))
