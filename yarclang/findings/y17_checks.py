"""Findings of family 17: the checks themselves."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1701",
        "needless-suppression",
        "warning",
        "a comment suppresses a finding that isn't there",
        "`! yarc: ignore[CODE]` at the end of a line, or alone above it, suppresses warnings and notes with "
        "that code on that line. If the cause has been corrected, remove the comment: it would hide the "
        "next finding of this kind.",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ! yarc: ignore[Y0603]",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        tag="unneeded",
    ),
    Finding(
        "Y1702",
        "bad-suppression",
        "warning",
        "a comment names a code that can't be suppressed",
        "A comment names the codes of the warnings or notes that it suppresses. Errors can't be "
        "suppressed: a program with an error can't be executed as written.",
        "P0010 MOVEJ 200 0 0 0 0 0 [5] (deg,s) ! yarc: ignore[Y0502]",
        "P0010 MOVEJ 160 0 0 0 0 0 [5] (deg,s)",
    ),
)
