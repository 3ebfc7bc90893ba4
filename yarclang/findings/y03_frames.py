"""Findings of family 03: frames and units."""

from yarclang.findings.finding import Finding, Follows

FINDINGS = (
    Finding(
        "Y0301",
        "unknown-frame",
        "error",
        "no frame has this name",
        "{B}, {FLANGE} and the tool frames come from the robot.",
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
        "A pose has no meaning without the frame that is moved and the frame in which the values are "
        "given. Neither is guessed.",
        "P0010 MOVEL 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        needs="default",
    ),
    Finding(
        "Y0303",
        "frame-in-wrong-place",
        "error",
        "this frame can't be moved, or can't be the base",
        "The moving frame sits on {FLANGE}; the base frame is fixed to {B}. Only DMOVE takes a base frame "
        "on the robot: its axes at the start.",
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
        "30 may be degrees or radians, 1.2 may be a metre or a millimetre: a factor of 57 or 1,000 at the "
        "machine. A line, or DEFAULT, says which.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
        needs="default",
    ),
    Finding(
        "Y0305",
        "unknown-unit",
        "error",
        "this is no unit",
        "Lengths: mm cm m um in. Angles: deg rad. Times: s ms min.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (degree,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0306",
        "two-units-of-a-kind",
        "error",
        "two units of the same kind",
        "A line has at most one unit of length, one of angle and one of time. Of two units it isn't "
        "known which one is meant.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,rad,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0307",
        "wrong-kind-of-unit",
        "error",
        "a value is of the wrong kind: length, angle, time or plain number",
        "A number keeps its unit through an expression and is converted at its use. Lengths and angles "
        "can't be added; a product of two lengths is not a length.",
        "LET TILT = 5 (deg)\nLET HIGH = TILT + 60 (mm)\nP0010 STOP",
        "LET EDGE = 5 (mm)\nLET HIGH = EDGE + 60 (mm)\nP0010 STOP",
    ),
)
