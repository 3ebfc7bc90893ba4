"""Bodies of the robot and its cell, how far they are apart, and whether they stay so along a motion."""
