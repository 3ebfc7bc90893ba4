"""Findings of family 03: frames and units."""

from yarclang.findings.finding import Finding, Follows

FINDINGS = (
    Finding(
        "Y0301",
        "unknown-frame",
        "error",
        "no frame has this name",
        "{B}, {FLANGE} and the tool frames come from the robot. All other frames come from the cell.toml, "
        "from a FRAME line above, or from a parameter of the SUB.",
        "P0010 MOVEL {TPC} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        needs="name",
        hides="names",
    ),
    Finding(
        "Y0302",
        "missing-frame",
        "error",
        "a moving frame or a base frame is missing",
        "A pose needs two frames: the frame that is moved, and the base frame of its values. Neither is "
        "guessed.",
        "P0010 MOVEL 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        needs="default",
    ),
    Finding(
        "Y0303",
        "frame-in-wrong-place",
        "error",
        "this frame can't be the moving frame or the base frame",
        "The moving frame must be fixed to {FLANGE}, and the base frame to {B}. Only DMOVE accepts a base "
        "frame that is fixed to the robot's flange: it moves along the axes that this frame has at the "
        "start of the motion.",
        "P0010 MOVEL {B} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {TCP}",
        "P0010 MOVEL {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        needs="meaning",
        hides="names",
        follows=(Follows("Y0301", "elsewhere"),),
    ),
    Finding(
        "Y0304",
        "missing-unit",
        "error",
        "a unit is missing",
        "30 may be in degrees or radians, and 1.2 in metres or millimetres: a factor of 57 or 1,000 on the "
        "machine. The line or DEFAULT must give the unit.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
        needs="default",
    ),
    Finding(
        "Y0305",
        "unknown-unit",
        "error",
        "the unit is unknown",
        "Lengths: mm cm m um in. Angles: deg rad. Times: s ms min.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (degree,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0306",
        "two-units-of-a-kind",
        "error",
        "two units of the same kind",
        "A line has at most one unit of length, one of angle and one of time. With two units of the same "
        "kind, the meaning of the values is not clear.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,rad,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0307",
        "wrong-kind-of-unit",
        "error",
        "a value is of the wrong kind: length, angle, time or plain number",
        "A number keeps its unit through an expression and is converted at its use. For example, a length "
        "and an angle can't be added, and a product of two lengths is not a length.",
        "LET TILT = 5 (deg)\nLET HIGH = TILT + 60 (mm)\nP0010 STOP",
        "LET EDGE = 5 (mm)\nLET HIGH = EDGE + 60 (mm)\nP0010 STOP",
    ),
)
