"""Starts the ROS 2 node, robot_state_publisher and, with rviz:=true, RViz. It waits up to a minute until
the robot is served.
"""

import sys
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = {
    "robot": (
        "",
        "name of the robot or of its process, or path of its socket; empty: the only one that is served",
    ),
    "action": ("joint_trajectory_controller/follow_joint_trajectory", "name of the action"),
    "hold_on_cancel": ("true", "hold a cancelled goal on its path at once"),
    "rviz": ("false", "start RViz"),
}


def generate_launch_description():
    """Return what `ros2 launch yarc_driver yarc.launch.py` starts."""
    told = [
        DeclareLaunchArgument(name, default_value=default, description=what)
        for name, (default, what) in ARGUMENTS.items()
    ]
    return LaunchDescription([*told, OpaqueFunction(function=_nodes)])


def _nodes(context):
    share = Path(get_package_share_directory("yarc_driver"))
    sys.path.insert(0, str(share / "lib"))
    from yarclang.ros.node.description import described  # noqa: PLC0415 (it is found in the folder above)

    robot = LaunchConfiguration("robot").perform(context)
    model = described(robot)
    given = {name: LaunchConfiguration(name) for name in ("robot", "action", "hold_on_cancel")}
    return [
        Node(
            package="yarc_driver",
            executable="yarc_ros2",
            name="yarc_driver",
            output="screen",
            parameters=[
                {
                    "robot": ParameterValue(given["robot"], value_type=str),
                    "action": ParameterValue(given["action"], value_type=str),
                    "hold_on_cancel": ParameterValue(given["hold_on_cancel"], value_type=bool),
                }
            ],
            on_exit=Shutdown(),
        ),
        Node(
            package="robot_state_publisher",
            executable="robot_state_publisher",
            parameters=[{"robot_description": ParameterValue(model["urdf"], value_type=str)}],
        ),
        Node(
            package="rviz2",
            executable="rviz2",
            arguments=["-d", str(share / "rviz" / "yarc_ros2.rviz"), "-f", model["base"]],
            condition=IfCondition(LaunchConfiguration("rviz")),
        ),
    ]
