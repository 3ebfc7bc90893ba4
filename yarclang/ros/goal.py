"""Conversion of a goal (a trajectory from ROS) to a program with one timed motion. The coordinator plans and
proves it like any other program. No I/O.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array, Robot
from yarclang.ros.motion import Goal

START_WITHIN = 0.01
"""Largest distance of a joint from its position in a goal's first waypoint at which the robot counts as being
at this waypoint [rad or m]. MoveIt's check has the same limit.
"""

LEAD_SHARE = 0.5
"""Largest share of the velocity and acceleration limits for the motion to a goal's first waypoint, which is
needed if the robot isn't at this waypoint.
"""

_SHORTEST_LEAD = 0.1
"""Shortest duration of the motion to the first waypoint [s]."""

_SINGLE = 1e-6
"""Tolerance of joint limits, because ROS clients round joint positions to single precision. It is relative to
the limit, or to 1 rad or 1 m if the limit is smaller.
"""

_NEXT = ";\n      "
"""Separator of waypoints. Each waypoint is on a line of its own, because the length of lines is limited."""

_SAME = 1e-6
"""If a goal has only one waypoint and no joint is farther from it than this, the robot doesn't move [rad or
m].
"""


def timetable(robot: Robot, goal: Goal, stands: Array) -> tuple[Array, Array]:
    """Return the waypoints of a goal and the times from its start to each of them.

    The duration of the first waypoint isn't used, because ROS-Industrial's client node computes it from the
    previous trajectory. If the robot is at the first waypoint, this waypoint is left out. Otherwise the
    time to this waypoint is computed from the distance and the limits. The velocity ratios of waypoints
    aren't used either, because they don't determine a motion.

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
    """Return the program that moves through waypoints at given times.

    Args:
        robot: robot that runs the program.
        positions: (k, n) waypoints with k >= 1 [rad or m].
        times: (k,) times since the start [s], increasing.
    """
    rows = (positions / robot.axis_units).tolist()
    points = (
        f"{' '.join(f'{value:.8f}' for value in row)} [{time:.6f}]"
        for row, time in zip(rows, times.tolist(), strict=True)
    )
    return f"P0010 MOVEJ_TIMED {_NEXT.join(points)} (mm,deg,s)\n"


def _within(robot: Robot, positions: Array) -> Array:
    """Return joint positions (k, n), clamped to the robot's limits if they exceed a limit by at most
    `_SINGLE`. Positions that exceed a limit by more are unchanged.
    """
    limits = robot.limits
    lower = limits.lower - _SINGLE * np.maximum(np.abs(limits.lower), 1.0)
    upper = limits.upper + _SINGLE * np.maximum(np.abs(limits.upper), 1.0)
    at_limit = np.clip(positions, limits.lower, limits.upper)
    found: Array = np.where((positions >= lower) & (positions <= upper), at_limit, positions)
    return found


def _lead(robot: Robot, away: Array) -> float:
    """Return the duration T of the motion to the first waypoint [s]. Each joint moves by a polynomial of
    degree five from rest to rest. Over the distance d, its peak velocity is 1.875 d/T and its peak
    acceleration 5.774 d/T².
    """
    limits = robot.limits
    by_velocity = 1.875 * away / (LEAD_SHARE * limits.velocity)
    by_acceleration = np.sqrt(5.774 * away / (LEAD_SHARE * limits.acceleration))
    return max(_SHORTEST_LEAD, float(by_velocity.max()), float(by_acceleration.max()))
