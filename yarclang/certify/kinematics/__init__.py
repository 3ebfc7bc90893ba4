"""The judge's own kinematics, computed from the texts of robot.toml and the URDF.

The room uses no code of `yarclang.robot.kinematics`.

`described` reads the numbers, `rotations` defines the conventions, `arm` computes the forward kinematics,
`motors` the motor positions, `elbow` the elbow. `pinocchio` compares the results with those of Pinocchio,
and `poses` compares the program's poses with the written numbers.
"""
