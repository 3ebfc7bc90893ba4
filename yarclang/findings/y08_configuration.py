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
)
