"""Family 03: frames and units."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0301",
        "unknown-frame",
        "error",
        "no frame has this name",
        "{B}, {FLANGE} and the tool frames come from the robot.",
        "P0010 MOVEL {TPC} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0302",
        "missing-frame",
        "error",
        "a moving frame or a base frame is missing",
        "A pose says nothing before it is known which frame is moved and in which axes the values count. Neither is guessed.",
        "P0010 MOVEL 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0303",
        "frame-in-wrong-place",
        "error",
        "this frame can't be moved, or can't be the base",
        "The moving frame sits on {FLANGE}; the base frame is fixed to {B}. Only DMOVE takes a base frame on the robot: its axes at the start.",
        "P0010 MOVEL {B} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {TCP}",
        "P0010 MOVEL {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0304",
        "missing-unit",
        "error",
        "a unit is missing",
        "30 may be degrees or radians, 1.2 may be a metre or a millimetre: a factor of 57 or 1,000 at the machine. A line, or DEFAULT, says which.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
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
        "At most one unit of length, one of angle and one of time: which of two would hold can't be known.",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,rad,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0307",
        "wrong-kind-of-unit",
        "error",
        "a length, an angle, a time or a plain number stands where another is wanted",
        "A number with a unit keeps it through an expression and is converted where it stands. Lengths and angles don't add; "
        "a product of two lengths is no length.",
        "LET TILT = 5 (deg)\nLET HIGH = TILT + 60 (mm)\nP0010 STOP",
        "LET EDGE = 5 (mm)\nLET HIGH = EDGE + 60 (mm)\nP0010 STOP",
    ),
)
