"""The judge's own kinematics, computed from the contents of robot.toml and of the URDF.

No code of `yarclang.robot.kinematics` is used here.

`described` reads the numbers, `rotations` defines the conventions, `arm` computes the forward kinematics,
`motors` the motor positions, `elbow` the elbow. `pinocchio` compares the results with those of Pinocchio,
and `poses` compares the poses that the program uses with the numbers that its author wrote.
"""
