"""A program's certified motion as trajectories for ROS."""
