"""The ROS nodes: a FollowJointTrajectory action on a robot that `yarc serve` owns. Python 3.8 and later, the standard library and `yarclang.client` only."""
