#!/usr/bin/python3
"""Send a trajectory to the ROS 1 node as MoveIt does, and say how it ends.

    PYTHONPATH=. /usr/bin/python3 examples/send_plan.py examples/moveit_plan.yaml

The file has a trajectory_msgs/JointTrajectory as `rostopic echo` writes it. PYTHONPATH is for the type of the
action: where control_msgs is installed, it isn't needed.
"""

import sys
from pathlib import Path

import actionlib
import rospy
import yaml
from actionlib_msgs.msg import GoalStatus
from genpy.message import fill_message_args

try:
    from control_msgs.msg import FollowJointTrajectoryAction
except ImportError:
    from yarclang.ros.node.interfaces import interfaces

    FollowJointTrajectoryAction = interfaces().action


def main() -> int:
    """Send the plan, and return 0 if the robot has arrived."""
    rospy.init_node("send_plan", anonymous=True)
    client = actionlib.SimpleActionClient("joint_trajectory_action", FollowJointTrajectoryAction)
    if not client.wait_for_server(rospy.Duration(10)):
        sys.exit("nobody offers joint_trajectory_action: is the node running?")
    goal = type(FollowJointTrajectoryAction().action_goal.goal)()
    fill_message_args(goal.trajectory, [yaml.safe_load(Path(sys.argv[1]).read_text())])
    print(
        f"{len(goal.trajectory.points)} points, {goal.trajectory.points[-1].time_from_start.to_sec():.3f} s"
    )
    client.send_goal(
        goal,
        feedback_cb=lambda fed: rospy.loginfo_throttle(
            0.5, "at %.2f s, J1 at %.4f rad", fed.desired.time_from_start.to_sec(), fed.actual.positions[0]
        ),
    )
    client.wait_for_result()
    state, result = client.get_state(), client.get_result()
    print(f"{GoalStatus.to_string(state)} ({result.error_code}) {result.error_string}".rstrip())
    return 0 if state == GoalStatus.SUCCEEDED else 1


if __name__ == "__main__":
    sys.exit(main())
