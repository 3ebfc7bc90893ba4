"""Findings of family 18: dynamics."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1801",
        "effort-exceeded",
        "error",
        "a motion needs more effort than a motor can give",
        "With the masses of the URDF and of the mounted tools, the motion needs more torque, or force, than "
        "the joint's effort. The drive would lag until the following error stops it. The message names the "
        "joint, the place, and the part of the effort that gravity takes. The rest decreases with the "
        "square of the duration. Friction and the inertia of the motors' rotors aren't included.",
        "[joints.shoulder]\neffort = 90     # N m; P0010 MOVEJ 90 0 0 0 0 0 [0.6] (deg,s)",
    ),
    Finding(
        "Y1802",
        "too-heavy",
        "error",
        "a motor can't hold the arm",
        "At this place, gravity alone needs more than the joint's effort, even at rest. Either the arm "
        "carries too much, or a mass, an effort or the direction of gravity is wrong.",
        "[tools.GRIPPER]\nmass = 80     # kg; 8 were meant",
        "[tools.GRIPPER]\nmass = 8",
    ),
)
