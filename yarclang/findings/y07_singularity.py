"""Findings of family 07: singularities."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0701",
        "singular-on-the-path",
        "error",
        "the path needs a joint to jump at a singularity",
        "If two axes line up, a straight motion may need a joint to turn by a finite angle in no time. The "
        "message says where and by how much. Use MOVEJ, or a via pose beside the singularity.",
    ),
    Finding(
        "Y0702",
        "near-singularity",
        "note",
        "the path comes near a singularity, and that costs time",
        "Near a singularity the moving frame's motion takes much more joint speed than elsewhere. The "
        "smallest singular value of the Jacobian, its lengths measured in the arm's reach, says how near: "
        "0 is on it, 0.1 to 0.5 far from it. The message names the place, the joint, and how fast it has "
        "to be there.",
    ),
)
