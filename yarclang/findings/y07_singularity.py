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
        "the path passes near a singularity, which costs time",
        "Near a singularity the joints must turn much faster for the same speed of the moving frame. The "
        "distance from the singularity is measured by the smallest singular value of the Jacobian (with "
        "lengths in units of the arm's reach): 0 is at the singularity, 0.1 to 0.5 is far from it. The "
        "message names the place, the joint, and the joint's speed there.",
    ),
)
