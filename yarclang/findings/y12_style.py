"""Family 12: style."""

from yarclang.findings.finding import Finding, Follows

FINDINGS = (
    Finding(
        "Y1201",
        "index-order",
        "warning",
        "indices don't ascend",
        "People look for P0030 behind P0020. Indices that ascend in the file are found.",
        "P0020 MOVEJ HOME [5] (s)\nP0010 STOP",
        "P0010 MOVEJ HOME [5] (s)\nP0020 STOP",
        follows=(Follows("Y0113", "above"),),
    ),
)
