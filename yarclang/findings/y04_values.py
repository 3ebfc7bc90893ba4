"""Family 04: values."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0401",
        "wrong-number-of-values",
        "error",
        "values are missing or surplus",
        "A joint position has one value for each joint; a pose has x y z and an orientation.",
        "P0010 MOVEJ 0 0 0 0 30 [5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0402",
        "not-a-number",
        "error",
        "this is not a number",
        "A number is an optional sign, digits with an optional decimal point, and an optional exponent; blanks stand between numbers. "
        "`30-5` may be meant as two values, `0,5` as 0.5: neither is guessed.",
        "P0010 MOVEJ 0 0 0 0 30-5 0 [5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 -5 [5] (deg,s)",
    ),
    Finding(
        "Y0403",
        "number-too-large",
        "error",
        "a number is beyond all reason",
        "Values beyond 1e9 can't be computed with; no robot has such a joint position or such a workspace.",
        "P0010 MOVEJ 0 0 0 0 1e999 0 [5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 10 0 [5] (deg,s)",
    ),
    Finding(
        "Y0404",
        "quaternion-norm",
        "error",
        "the quaternion's norm isn't 1",
        "qx qy qz qw of an orientation have the norm 1. A norm off by more than 0.001 shows a value that is missing, mistyped or in another order.",
        "P0010 MOVEJ_QUAT {TCP} 0 1174.4 1176 0 0 0 2 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_QUAT {TCP} 0 1174.4 1176 0 0 0 1 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0405",
        "wrong-number-of-way-points",
        "error",
        "way-points are missing or surplus",
        "MOVEJ and MOVEL go to one way-point, a spline runs through two or more, separated by semicolons.",
        "P0010 MOVEJ 0 0 0 0 0 0; 0 0 0 0 30 0 [5] (deg,s)",
        "P0010 MOVEJ_SPLINE 0 0 0 0 10 0; 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0406",
        "missing-time",
        "error",
        "the motion time is missing",
        "How fast the arm moves is never guessed: `[20]` is the duration of the whole motion, `[MIN]` the shortest that the limits allow.",
        "P0010 MOVEJ 0 0 0 0 30 0 (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [MIN] (deg,s)",
    ),
    Finding(
        "Y0407",
        "bad-time",
        "error",
        "this is no motion time",
        "A motion time is a positive number with a unit of time, or MIN.",
        "P0010 MOVEJ 0 0 0 0 30 0 [-5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0408",
        "surplus-part",
        "error",
        "the command doesn't take this part",
        "A part that a command doesn't use shows that another command was meant.",
        "P0010 STOP [5] (s)",
        "P0010 STOP",
    ),
    Finding(
        "Y0409",
        "half-turn",
        "error",
        "a turn by half a revolution has no short way",
        "A straight motion turns about one axis, the short way. At half a turn both ways are equally long, and beyond it the other "
        "way is the short one: a via pose says which is meant.",
        "P0010 DMOVE {TCP} 0 0 0 0 180 0 [5] (mm,deg,s) {B}",
        "P0010 DMOVE {TCP} 0 0 0 0 90 0 [5] (mm,deg,s) {B}\nP0020 DMOVE {TCP} 0 0 0 0 90 0 [5] (mm,deg,s) {B}",
    ),
)
