"""Findings of family 11, third part: findings of the judge about the controller's settings."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1170",
        "settings-unreadable",
        "error",
        "the settings text isn't what yarc settings prints",
        "Every program depends on the settings: where joints are, how the robot stops, what happens if "
        "this computer fails. Their reader accepts only the lines that `yarc settings` prints, each once "
        "and in its place. Comments and empty lines may be added; any other line would be unchecked.",
    ),
    Finding(
        "Y1171",
        "settings-of-another-robot",
        "error",
        "the settings were made for another robot, or for the robot as it was",
        "The header of the settings names the robot and a fingerprint of its geometry, limits, actuation "
        "and controller. With the settings of another one, the same program moves other motors by other "
        "amounts.",
    ),
    Finding(
        "Y1172",
        "wrong-axis-definition",
        "error",
        "an axis definition isn't the robot's K J and a0",
        "The controller turns joint values into motor positions by the axis definitions. If they aren't "
        "counts = K J q + a0, the arm goes elsewhere than the path that was proved.",
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
        "Software limits, the decelerations of an abort, the speed of RAPID, the time of a hold, and the "
        "time base of splines are part of every certificate. With another value a joint can exceed its "
        "limits, or a motion can run at another speed than was proved.",
    ),
    Finding(
        "Y1175",
        "weak-guard",
        "error",
        "the guard of the rotary buffer doesn't hold the motion in time",
        "If this computer fails while a program is streamed, only PLC 29 stops the robot on its path. The "
        "PLC must run, watch the right bit, and be triggered early enough (I16, I17) for a hold to end "
        "before the buffer is empty.",
    ),
    Finding(
        "Y1176",
        "settings-differ",
        "warning",
        "a setting differs from what yarc settings prints",
        "The proof of the settings holds for this value too. But `yarc doctor` and each run compare the "
        "controller with the output of `yarc settings`, and refuse another value.",
    ),
)
