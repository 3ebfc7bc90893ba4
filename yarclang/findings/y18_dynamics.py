"""Family 18: dynamics."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1801",
        "effort-exceeded",
        "error",
        "a motor can't give what the motion asks for",
        "With the masses of the URDF and of the mounted tools, the motion needs more torque, or force, than the joint's effort: the drive would fall behind its program until the following error "
        "stops it. The message names the joint, the place and how much of it gravity takes; the rest shrinks with the square of the time. Friction and the motors' rotors aren't in it.",
        "[joints.shoulder]\neffort = 90     # N m; P0010 MOVEJ 90 0 0 0 0 0 [0.6] (deg,s)",
    ),
    Finding(
        "Y1802",
        "too-heavy",
        "error",
        "a motor can't hold the arm",
        "At this place gravity alone asks for more than the joint's effort, however slowly the arm gets there. Either it carries too much, or a mass, an effort or the direction of "
        "gravity isn't right.",
        "[tools.GRIPPER]\nmass = 80     # kg; 8 were meant",
        "[tools.GRIPPER]\nmass = 8",
    ),
)
