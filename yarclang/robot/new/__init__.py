"""Make a robot folder from a URDF: choose the arm's chain, take over the values of the URDF, and guess
missing values by rules. Each guess is marked in the robot.toml.
"""
