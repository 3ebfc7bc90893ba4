"""Export of programs and robots to other tools: trajectories for ROS, and configuration packages for
MoveIt.
"""
