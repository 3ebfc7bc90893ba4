"""Findings of family 13: a robot's joints, their limits, axes and motors."""

from __future__ import annotations

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1312",
        "joint-without-table",
        "error",
        "a joint of the URDF has no table of limits",
        "Every joint between base and flange moves, and needs limits for the planner.",
        "[joints.J1]",
        "[joints.J1]\n...\n[joints.J2]",
    ),
    Finding(
        "Y1313",
        "table-without-joint",
        "error",
        "the table belongs to no joint",
        "The tables of [joints] have the names of the URDF's joints between base and flange.",
        "[joints.joint_1]",
        "[joints.J1]",
    ),
    Finding(
        "Y1314",
        "joint-order",
        "warning",
        "the tables aren't in the order of the chain",
        "HOME, K, J and the other lists are in the order of the chain. A reader of the file would expect "
        "the order of the tables.",
        "[joints.J2]\n[joints.J1]",
        "[joints.J1]\n[joints.J2]",
    ),
    Finding(
        "Y1315",
        "no-position-limits",
        "error",
        "the joint has no position limits",
        "Only a continuous joint turns without end; any other has end stops that a plan must avoid.",
        "[joints.J1]\nvelocity = 60",
        "[joints.J1]\nposition = [-170, 170]\nvelocity = 60",
    ),
    Finding(
        "Y1316",
        "limits-crossed",
        "error",
        "the lower limit isn't below the upper",
        "No position is within such limits, so nothing could be planned.",
        "position = [170, -170]",
        "position = [-170, 170]",
    ),
    Finding(
        "Y1317",
        "position-outside-limits",
        "error",
        "a named position is outside of the limits",
        "Programs start at HOME or at another named position. From a position outside of the limits, every "
        "plan would be refused.",
        "HOME = [0, 100, 0, 0, 0, 0]",
        "HOME = [0, 90, 0, 0, 0, 0]",
    ),
    Finding(
        "Y1318",
        "too-many-joints",
        "error",
        "the robot has more joints than the controller has axes",
        "A coordinate system of the controller has the nine axes X Y Z A B C U V W, and each joint is one "
        "of them.",
    ),
    Finding(
        "Y1319",
        "zero-gear",
        "error",
        "a gear ratio is zero",
        "K is the motor's counts per deg (or mm); with 0 the joint's position can't be computed from the "
        "motor's.",
        "K = [0, 25667.875]",
        "K = [25532.8278, 25667.875]",
    ),
    Finding(
        "Y1320",
        "singular-coupling",
        "error",
        "the matrix J can't be inverted",
        "The joint positions are computed from the motor positions with the inverse of K J (eq. 4 of the "
        "YARC paper). If J can't be inverted, the robot's position isn't known.",
        "J = [[1, 1], [2, 2]]",
        "J = [[1, 1], [1, -1]]",
    ),
    Finding(
        "Y1321",
        "bad-axis",
        "error",
        "the controller has no such axis",
        "Axes are named X Y Z A B C U V W.",
        'axes = ["Q"]',
        'axes = ["X"]',
    ),
    Finding(
        "Y1322",
        "axis-twice",
        "error",
        "an axis belongs to two joints",
        "A move line names each axis once, so two joints on one axis would always move together.",
        'axes = ["X", "X"]',
        'axes = ["X", "Y"]',
    ),
    Finding(
        "Y1323",
        "motor-twice",
        "error",
        "a motor belongs to two joints",
        "A motor has one definition in a coordinate system: the second would replace the first.",
        "numbers = [1, 1]",
        "numbers = [1, 2]",
    ),
    Finding(
        "Y1324",
        "uncoupleable-axes",
        "error",
        "the controller can't couple these axes",
        "A motor's definition may add up several axes only if all are among X Y Z or all are among U V W. "
        "A, B and C are rotary axes and can't be combined (TSRM 269).",
        'axes = ["X", "Y", "Z", "A", "B", "C"]  # J couples the last two',
        'axes = ["X", "Y", "Z", "A", "U", "V"]',
    ),
    Finding(
        "Y1325",
        "coupling-count",
        "error",
        "the numbers of coupled joints and of their motors differ",
        "Coupled joints need exactly as many motors as joints. With fewer motors, some joint couldn't be "
        "moved by itself; with more motors, their positions could contradict each other.",
        "J = [[1, 1], [0, 0]]",
        "J = [[1, 1], [0, 1]]",
    ),
    Finding(
        "Y1326",
        "bad-feedback",
        "error",
        "the feedback variable can't be used",
        "PLC 0 writes the joint positions to P variables; P8100 and above are reserved for the guard.",
        'feedback = ["Q1"]',
        'feedback = ["P1"]',
    ),
    Finding(
        "Y1327",
        "feedback-twice",
        "error",
        "a feedback variable belongs to two joints",
        "The second joint would overwrite the position of the first.",
        'feedback = ["P1", "P1"]',
        'feedback = ["P1", "P2"]',
    ),
)
