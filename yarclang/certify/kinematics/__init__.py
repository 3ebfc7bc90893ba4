"""The judge's own kinematics, from the texts of robot.toml and URDF.

It uses no code of `yarclang.robot.kinematics`.

`described` reads the numbers, `rotations` defines the conventions, `arm` computes the forward kinematics,
`motors` the motor positions, `elbow` the elbow. `pinocchio` compares the results with a third party's,
`poses` compares the program's poses with the written numbers.
"""
