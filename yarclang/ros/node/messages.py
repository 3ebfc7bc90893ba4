"""Conversion between ROS 1 messages and the driver's values. It uses only field names, and gets the message
classes as arguments, so it doesn't import ROS.

Written for Python 3.8 and later.
"""

from __future__ import annotations

from typing import Any, Tuple

from yarclang.ros.node.action import Feedback, Moment, Result
from yarclang.ros.node.driver import JointState, Status
from yarclang.ros.node.trajectory import Goal, Point, Tolerance


def goal_of(goal: Any, now: Any) -> Goal:
    """Convert the goal of the action from its ROS message to the driver's `Goal`.

    Args:
        goal: control_msgs/FollowJointTrajectoryGoal.
        now: ROS time, from which the header's stamp is subtracted.
    """
    trajectory = goal.trajectory
    return Goal(
        tuple(trajectory.joint_names),
        _points_of(trajectory),
        _starts_in(trajectory, now),
        _tolerances_of(goal.path_tolerance),
        _tolerances_of(goal.goal_tolerance),
        float(goal.goal_time_tolerance.to_sec()),
    )


def path_of(trajectory: Any, now: Any) -> Goal:
    """Convert a trajectory_msgs/JointTrajectory to a goal without tolerances; the default tolerances apply.
    `now` is the ROS time, from which the header's stamp is subtracted.
    """
    return Goal(tuple(trajectory.joint_names), _points_of(trajectory), _starts_in(trajectory, now))


def result_message(kind: Any, result: Result) -> Any:
    """Return a goal's result as a message of the class `kind` (control_msgs/FollowJointTrajectoryResult)."""
    return kind(error_code=result.error_code, error_string=result.error_string)


def feedback_message(kind: Any, feedback: Feedback, stamp: Any) -> Any:
    """Return a goal's feedback as a message of the class `kind`
    (control_msgs/FollowJointTrajectoryFeedback).
    """
    message = kind(joint_names=list(feedback.joint_names))
    message.header.stamp = stamp
    _fill(message.desired, feedback.desired)
    _fill(message.actual, feedback.actual)
    _fill(message.error, feedback.error)
    return message


def standing_message(kind: Any, state: JointState, stamp: Any) -> Any:
    """Return the joints' state as feedback while there is no goal: `desired` and `error` are empty. `kind` is
    the class control_msgs/FollowJointTrajectoryFeedback.
    """
    message = kind(joint_names=list(state.names))
    message.header.stamp = stamp
    _fill(message.actual, Moment(state.positions, state.velocities))
    return message


def joint_state_message(kind: Any, state: JointState, stamp: Any) -> Any:
    """Return the joints' state as a message of the class `kind` (sensor_msgs/JointState)."""
    message = kind(name=list(state.names), position=list(state.positions), velocity=list(state.velocities))
    message.header.stamp = stamp
    return message


def status_message(kind: Any, status: Status, stamp: Any) -> Any:
    """Return the robot's status as a message of the class `kind` (industrial_msgs/RobotStatus)."""
    message = kind(error_code=status.error_code)
    message.header.stamp = stamp
    for name in ("mode", "e_stopped", "drives_powered", "motion_possible", "in_motion", "in_error"):
        getattr(message, name).val = getattr(status, name)
    return message


def _points_of(trajectory: Any) -> Tuple[Point, ...]:
    return tuple(
        Point(
            tuple(one.positions),
            float(one.time_from_start.to_sec()),
            tuple(one.velocities),
            tuple(one.accelerations),
        )
        for one in trajectory.points
    )


def _starts_in(trajectory: Any, now: Any) -> float:
    """Return the time until the stamp [s]: 0 without a stamp, negative for a past one."""
    stamp = trajectory.header.stamp
    return 0.0 if stamp.is_zero() else float((stamp - now).to_sec())


def _tolerances_of(tolerances: Any) -> Tuple[Tolerance, ...]:
    return tuple(Tolerance(one.name, one.position, one.velocity, one.acceleration) for one in tolerances)


def _fill(point: Any, moment: Moment) -> None:
    """Write the state of the joints at one time into a trajectory_msgs/JointTrajectoryPoint."""
    point.positions, point.velocities = list(moment.positions), list(moment.velocities)
    point.accelerations = list(moment.accelerations)
    point.time_from_start = type(point.time_from_start).from_sec(moment.time)
