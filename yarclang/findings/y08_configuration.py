"""Findings of family 08: configuration."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0801",
        "configuration-change",
        "error",
        "the path needs another configuration between start and end",
        "A straight motion keeps the arm's configuration (shoulder, elbow, wrist, full turns). If the "
        "target can be reached only in another configuration, use MOVEJ, which may change the "
        "configuration.",
    ),
    Finding(
        "Y0802",
        "not-the-nearest",
        "warning",
        "a target isn't reached in the nearest configuration, because a later motion can't start from there",
        "A pose can be reached in several configurations. Usually the one nearest to the current joint "
        "position is taken. Here, a later Cartesian motion can't start from that configuration, so the "
        "nearest configuration from which the later motion works is taken instead, and the arm moves "
        "farther than expected. NEAR with a joint position states which configuration is intended.",
    ),
)
