"""Find the paths of single motions from the robot's position, with a module for each kind of motion."""
