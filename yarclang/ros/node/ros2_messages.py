"""Conversion between ROS 2 messages and the driver's values. It uses only field names, and gets the message
classes as arguments, so it doesn't import ROS.

Fields that only some distributions have are read if they exist, and are never set. Written for Python 3.8 and
later.
"""

from __future__ import annotations

import math
from typing import Any, Dict, Tuple

from yarclang.ros.node.action import Feedback
from yarclang.ros.node.driver import JointState, Status
from yarclang.ros.node.trajectory import Goal, Moment, Point, Result, Tolerance

LONGEST = float(2**31 - 1)
"""Longest time of builtin_interfaces/Duration [s]. Longer times are set to this value."""

OK, WARN, ERROR = b"\x00", b"\x01", b"\x02"
"""Levels of diagnostic_msgs/DiagnosticStatus."""

_MODES = {-1: "unknown", 1: "manual", 2: "automatic"}
_SAID = {-1: "unknown", 0: "no", 1: "yes"}


def seconds_of(time: Any) -> float:
    """Return a builtin_interfaces/Duration or Time in seconds."""
    return float(time.sec) + 1e-9 * float(time.nanosec)


def fill_duration(message: Any, seconds: float) -> None:
    """Write a time [s] into a builtin_interfaces/Duration, to the nearest nanosecond. NaN becomes 0."""
    within = 0.0 if math.isnan(seconds) else max(-LONGEST, min(LONGEST, seconds))
    message.sec, message.nanosec = divmod(round(within * 1e9), 1_000_000_000)


def goal_of(goal: Any, now: Any) -> Goal:
    """Convert the goal of the action from its ROS message to the driver's `Goal`.

    Args:
        goal: control_msgs/action/FollowJointTrajectory.Goal.
        now: builtin_interfaces/Time, from which the header's stamp is subtracted.
    """
    trajectory = goal.trajectory
    return Goal(
        tuple(trajectory.joint_names),
        tuple(_point_of(one) for one in trajectory.points),
        _starts_in(trajectory.header.stamp, now),
        _tolerances_of(goal.path_tolerance),
        _tolerances_of(goal.goal_tolerance),
        seconds_of(goal.goal_time_tolerance),
    )


def multi_dof_joints(goal: Any) -> Tuple[str, ...]:
    """Return the names of the planar and floating joints of a goal. No robot of yarclang has such joints. In
    older distributions of ROS 2, goals have no field for them.
    """
    trajectory = getattr(goal, "multi_dof_trajectory", None)
    return () if trajectory is None else tuple(trajectory.joint_names)


def result_message(kind: Any, result: Result) -> Any:
    """Return a result as a message of the class `kind` (FollowJointTrajectory.Result)."""
    return kind(error_code=result.error_code, error_string=result.error_string)


def feedback_message(kind: Any, feedback: Feedback, stamp: Any) -> Any:
    """Return feedback as a message of the class `kind` (FollowJointTrajectory.Feedback)."""
    message = kind(joint_names=list(feedback.joint_names))
    message.header.stamp = stamp
    _fill_point(message.desired, feedback.desired)
    _fill_point(message.actual, feedback.actual)
    _fill_point(message.error, feedback.error)
    return message


def joint_state_message(kind: Any, state: JointState, stamp: Any) -> Any:
    """Return the joints' state as a message of the class `kind` (sensor_msgs/msg/JointState)."""
    message = kind(name=list(state.names), position=list(state.positions), velocity=list(state.velocities))
    message.header.stamp = stamp
    return message


def diagnostics_message(array: Any, entry: Any, pair: Any, name: str, status: Status, stamp: Any) -> Any:
    """Return the robot's status as one entry of diagnostics.

    Args:
        array: the class diagnostic_msgs/msg/DiagnosticArray.
        entry: the class diagnostic_msgs/msg/DiagnosticStatus.
        pair: the class diagnostic_msgs/msg/KeyValue.
        name: name of the robot.
        status: status of the robot.
        stamp: builtin_interfaces/Time.
    """
    values = [pair(key=key, value=value) for key, value in shown(status).items()]
    message = array(
        status=[
            entry(
                level=level_of(status),
                name=f"yarc: {name}",
                message=status.why or "ready",
                hardware_id=name,
                values=values,
            )
        ]
    )
    message.header.stamp = stamp
    return message


def level_of(status: Status) -> bytes:
    """Return the diagnostic level of a robot's status: ERROR after a failure, WARN while goals can't be
    accepted, otherwise OK.
    """
    if status.in_error == 1:
        return ERROR
    return OK if status.motion_possible == 1 or status.in_motion == 1 else WARN


def shown(status: Status) -> Dict[str, str]:
    """Return the fields of a robot's status as texts. The keys are the field names of ROS 1's
    industrial_msgs/RobotStatus.
    """
    words = {"mode": _MODES.get(status.mode, "unknown")}
    for name in ("e_stopped", "drives_powered", "motion_possible", "in_motion", "in_error"):
        words[name] = _SAID.get(getattr(status, name), "unknown")
    return {**words, "error_code": str(status.error_code)}


def _point_of(point: Any) -> Point:
    return Point(
        tuple(point.positions),
        seconds_of(point.time_from_start),
        tuple(point.velocities),
        tuple(point.accelerations),
    )


def _starts_in(stamp: Any, now: Any) -> float:
    """Return the time until the stamp [s]: 0 without a stamp, negative for a past one."""
    if stamp.sec == 0 and stamp.nanosec == 0:
        return 0.0
    return float(stamp.sec - now.sec) + 1e-9 * float(stamp.nanosec - now.nanosec)


def _tolerances_of(tolerances: Any) -> Tuple[Tolerance, ...]:
    return tuple(Tolerance(one.name, one.position, one.velocity, one.acceleration) for one in tolerances)


def _fill_point(point: Any, moment: Moment) -> None:
    """Write the state of the joints at one time into a trajectory_msgs/JointTrajectoryPoint."""
    point.positions, point.velocities = list(moment.positions), list(moment.velocities)
    point.accelerations = list(moment.accelerations)
    fill_duration(point.time_from_start, moment.time)
