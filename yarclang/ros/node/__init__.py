"""The ROS nodes: a FollowJointTrajectory action for a robot that `yarc serve` owns. They require Python 3.8,
and only the standard library and `yarclang.client`.
"""
