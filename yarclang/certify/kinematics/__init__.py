"""The judge's own kinematics: from the texts of robot.toml and URDF, with no line shared with `yarclang.robot.kinematics`.

`described` reads the numbers, `rotations` has the conventions, `arm` the forward kinematics, `motors` the actuation, `elbow` the elbow; `pinocchio`
asks a third party, `poses` holds the program's poses to the numbers that were written.
"""
