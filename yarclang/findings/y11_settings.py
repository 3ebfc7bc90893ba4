"""Findings of family 11, third part: findings of the judge about the controller's settings."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1170",
        "settings-unreadable",
        "error",
        "the settings text isn't what yarc settings prints",
        "Every program depends on the settings: they define where the joints are, how the robot stops, and "
        "what happens if this computer fails. The judge accepts only the lines that `yarc settings` prints, "
        "each once and in its place, because it couldn't check any other line. Comments and empty lines may "
        "be added.",
    ),
    Finding(
        "Y1171",
        "settings-of-another-robot",
        "error",
        "the settings were made for another robot, or for an earlier state of this one",
        "The header of the settings names the robot and a fingerprint of its geometry, limits, actuation "
        "and controller. With the settings of another robot, a program would move other motors, or move "
        "them by other amounts.",
    ),
    Finding(
        "Y1172",
        "wrong-axis-definition",
        "error",
        "an axis definition isn't the robot's K J and a0",
        "By its axis definitions, the controller computes motor positions from joint values. The "
        "definitions must be counts = K J q + a0, otherwise the arm leaves the proved path.",
    ),
    Finding(
        "Y1173",
        "wrong-feedback",
        "error",
        "PLC 0 doesn't compute the joint positions",
        "PLC 0 computes the joint positions from the motors' actual positions, and must invert the axis "
        "definitions. Otherwise positions in logs and other programs are wrong.",
    ),
    Finding(
        "Y1174",
        "unsafe-setting",
        "error",
        "an I-variable of the settings isn't what the certificate assumes",
        "Every certificate assumes certain values of software limits, the decelerations of an abort, the "
        "speed of RAPID, the time of a hold, and the time base of splines. With another value, a joint can "
        "exceed its limits, or a motion can run at a speed that wasn't proved.",
    ),
    Finding(
        "Y1175",
        "weak-guard",
        "error",
        "the guard of the rotary buffer doesn't hold the motion in time",
        "If this computer fails while a program is streamed, only PLC 29, the guard, stops the robot on its "
        "path. PLC 29 must run, watch the right bit, and react early enough (I16, I17) for a hold to end "
        "before the buffer is empty.",
    ),
    Finding(
        "Y1176",
        "settings-differ",
        "warning",
        "a setting differs from what yarc settings prints",
        "The value is safe: the proof of the settings holds for it too. But `yarc doctor` and each run "
        "compare the controller with the output of `yarc settings`, and refuse another value.",
    ),
)
