"""Family 07: singularities."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0701",
        "singular-on-the-path",
        "error",
        "the path needs a joint to jump at a singularity",
        "Where two axes line up, a straight motion may need a joint to turn by a finite angle in no time. The message says "
        "where and by how much. Other ways: MOVEJ, or a via pose beside the singularity.",
    ),
)
