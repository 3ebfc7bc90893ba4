"""Route single motions from the robot's position, each kind in its own module."""
