"""Export of the certified motion of a program as trajectories for ROS."""
