"""Findings of family 08: configuration."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0801",
        "configuration-change",
        "error",
        "the path needs another configuration between start and end",
        "A straight motion keeps the arm's configuration (shoulder, elbow, wrist, full turns). If the "
        "target can be reached only in another configuration, the arm can't get there on a straight line. "
        "MOVEJ can.",
    ),
    Finding(
        "Y0802",
        "not-the-nearest",
        "warning",
        "a target is taken in another configuration than the nearest",
        "A pose has several inverse-kinematics solutions, and the nearest is taken. If a Cartesian motion "
        "after it can't be done from there, the next nearest is taken, and the arm moves farther than "
        "expected. NEAR with a joint position states which one is meant.",
    ),
)
