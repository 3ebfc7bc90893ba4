"""YAML files of a MoveIt configuration: joint limits, inverse kinematics solver, controllers of ROS 1 and
ROS 2.
"""

from __future__ import annotations

import numpy as np

from yarclang.export.moveit.srdf import GROUP
from yarclang.export.numbers import number, text, texts
from yarclang.robot.model import Robot

HEAD = "# Written by yarc export for MoveIt."
ACTION_1 = "joint_trajectory_action"
"""Name of the action that ROS-Industrial's drivers provide."""
CONTROLLER_2, ACTION_2 = "joint_trajectory_controller", "follow_joint_trajectory"

VELOCITY_SHARE, ACCELERATION_SHARE = 0.9, 0.6
"""Limits of velocity and acceleration for MoveIt's plans, as fractions of the robot's limits.

The accelerations in MoveIt's plans jump. A smooth motion through the points of a plan needs up to 1.4 times
the plan's acceleration.
"""


def settings_files(robot: Robot) -> dict[str, str]:
    """Return the texts of the YAML files of a MoveIt configuration, by their paths in the package."""
    return {
        "config/joint_limits.yaml": _limits(robot),
        "config/kinematics.yaml": _kinematics(robot),
        "config/joint_names.yaml": f"{HEAD} For drivers of ROS-Industrial.\ncontroller_joint_names: "
        f"{texts(robot.joint_names)}\n",
        "config/ros_controllers.yaml": _controllers_1(robot),
        "config/moveit_controllers.yaml": _controllers_2(robot),
    }


def _limits(robot: Robot) -> str:
    limits = robot.limits
    lines = [
        f"{HEAD} rad, m, s.",
        "# Between the points of a plan at all limits a smooth path breaks them: leave it this room.",
        f"default_velocity_scaling_factor: {VELOCITY_SHARE}",
        f"default_acceleration_scaling_factor: {ACCELERATION_SHARE}",
        "joint_limits:",
    ]
    for at, name in enumerate(robot.joint_names):
        bounded = bool(np.isfinite([limits.lower[at], limits.upper[at]]).all())
        lines += [f"  {text(name)}:", f"    has_position_limits: {str(bounded).lower()}"]
        if bounded:
            lines += [
                f"    min_position: {number(limits.lower[at])}",
                f"    max_position: {number(limits.upper[at])}",
            ]
        for kind in ("velocity", "acceleration", "jerk"):
            lines += [f"    has_{kind}_limits: true", f"    max_{kind}: {number(getattr(limits, kind)[at])}"]
    return "\n".join(lines) + "\n"


def _kinematics(robot: Robot) -> str:
    lines = [
        f"{HEAD} Any other solver of MoveIt will do.",
        f"{GROUP}:",
        "  kinematics_solver: kdl_kinematics_plugin/KDLKinematicsPlugin",
        "  kinematics_solver_search_resolution: 0.005",
        "  kinematics_solver_timeout: 0.05",
    ]
    # With fewer than six joints, not every pose has a solution, so the solver ignores the orientation.
    return "\n".join([*lines, *["  position_only_ik: true"] * (robot.size < 6)]) + "\n"


def _controllers_1(robot: Robot) -> str:
    return "\n".join(
        [
            f"{HEAD} ROS 1: MoveIt's simple controller manager, and the action of ROS-Industrial's drivers.",
            "moveit_controller_manager: moveit_simple_controller_manager/MoveItSimpleControllerManager",
            "controller_list:",
            f"- name: {text('')}",
            f"  action_ns: {ACTION_1}",
            "  type: FollowJointTrajectory",
            "  default: true",
            f"  joints: {texts(robot.joint_names)}",
            "",
        ]
    )


def _controllers_2(robot: Robot) -> str:
    return "\n".join(
        [
            f"{HEAD} ROS 2: MoveIt's simple controller manager.",
            "moveit_controller_manager: moveit_simple_controller_manager/MoveItSimpleControllerManager",
            "moveit_simple_controller_manager:",
            f"  controller_names: {texts([CONTROLLER_2])}",
            f"  {CONTROLLER_2}:",
            f"    action_ns: {ACTION_2}",
            "    type: FollowJointTrajectory",
            "    default: true",
            f"    joints: {texts(robot.joint_names)}",
            "",
        ]
    )
