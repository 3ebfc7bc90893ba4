"""The rules of FollowJointTrajectory as a state machine: goals, positions and the time go in, what is to be done comes out. No I/O, no threads, no clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

from yarclang.ros.node.trajectory import Values

SUCCESSFUL = 0
INVALID_GOAL = -1
INVALID_JOINTS = -2
OLD_HEADER_TIMESTAMP = -3
PATH_TOLERANCE_VIOLATED = -4
GOAL_TOLERANCE_VIOLATED = -5


@dataclass(frozen=True)
class Result:
    """What a goal ends with.

    Attributes:
        error_code: one of the constants of control_msgs/FollowJointTrajectoryResult.
        error_string: the reason, or a note; may be empty.
    """

    error_code: int
    error_string: str = ""


@dataclass(frozen=True)
class Moment:
    """The joints at one time, in the order of the feedback's joint names.

    Attributes:
        positions: [rad or m].
        velocities: [rad/s or m/s].
        accelerations: [rad/s² or m/s²]; empty: not known.
        time: since the goal's start, in time of the trajectory [s].
    """

    positions: Values
    velocities: Values = ()
    accelerations: Values = ()
    time: float = 0.0


@dataclass(frozen=True)
class Feedback:
    """How a goal goes on, 50 times a second while it moves.

    Attributes:
        joint_names: in the order of the goal.
        desired: what the goal asks for at the program's time: a slower pace or a hold delays it.
        actual: what the controller has.
        error: desired - actual.
    """

    joint_names: Tuple[str, ...]
    desired: Moment
    actual: Moment
    error: Moment
