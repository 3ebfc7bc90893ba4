"""Programs and robots in the files of other tools: trajectories for ROS, and MoveIt's configuration."""
