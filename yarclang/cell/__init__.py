"""Read and check cell.toml: the robot's surroundings, in SI."""
