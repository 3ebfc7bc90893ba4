"""A goal of FollowJointTrajectory: its parts, what it must be like, and the path that it asks for. No I/O, no clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

Values = Tuple[float, ...]


@dataclass(frozen=True)
class Joint:
    """A joint of the robot.

    Attributes:
        name: as robot.toml and the URDF have it.
        unit: "deg" or "mm": the unit in which the coordinator has its positions.
    """

    name: str
    unit: str


@dataclass(frozen=True)
class Point:
    """A way-point, in the order of the goal's joint names.

    Attributes:
        positions: [rad or m].
        time_from_start: [s].
        velocities: [rad/s or m/s]; empty: none are given.
        accelerations: [rad/s² or m/s²]; empty: none are given.
    """

    positions: Values
    time_from_start: float
    velocities: Values = ()
    accelerations: Values = ()


@dataclass(frozen=True)
class Tolerance:
    """A tolerance of one joint, as control_msgs/JointTolerance: 0 is the default, -1 (any value below 0) none.

    Attributes:
        name: of the joint.
        position: [rad or m].
        velocity: [rad/s or m/s].
        acceleration: [rad/s² or m/s²].
    """

    name: str
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0


@dataclass(frozen=True)
class Goal:
    """A goal as it arrives.

    Attributes:
        joint_names: all joints of the robot, in any order.
        points: the way-points.
        starts_in: time from now until the goal is to begin, by the stamp of its header [s]; 0: at once (also for a header without a stamp).
        path_tolerance: how far joints may be from the path on the way.
        goal_tolerance: how far joints may be from the last point at the end.
        goal_time_tolerance: how much later than its last point the goal may end [s]; 0: the default.
    """

    joint_names: Tuple[str, ...]
    points: Tuple[Point, ...]
    starts_in: float = 0.0
    path_tolerance: Tuple[Tolerance, ...] = ()
    goal_tolerance: Tuple[Tolerance, ...] = ()
    goal_time_tolerance: float = 0.0
