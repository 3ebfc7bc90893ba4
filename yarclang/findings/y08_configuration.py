"""Family 08: configuration."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0801",
        "configuration-change",
        "error",
        "the path needs another configuration half way",
        "A straight motion keeps the arm's configuration (shoulder, elbow, wrist, full turns). Where the target can be reached only "
        "in another one, the arm can't get there straight. MOVEJ can.",
    ),
    Finding(
        "Y0802",
        "not-the-nearest",
        "warning",
        "a target is taken in another configuration than the nearest",
        "A pose has several inverse-kinematics solutions, and the nearest is taken. Where a Cartesian motion that follows can't be done "
        "from there, the next one is: the arm then moves farther than one might expect. NEAR with a joint position says that it is meant.",
    ),
)
