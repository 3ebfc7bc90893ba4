"""Findings of family 12: style."""

from yarclang.findings.finding import Finding, Follows

FINDINGS = (
    Finding(
        "Y1201",
        "index-order",
        "warning",
        "indices don't ascend",
        "Readers look for P0030 after P0020, and find ascending indices quickly.",
        "P0020 MOVEJ HOME [5] (s)\nP0010 STOP",
        "P0010 MOVEJ HOME [5] (s)\nP0020 STOP",
        follows=(Follows("Y0113", "above"),),
    ),
)
