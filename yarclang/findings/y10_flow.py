"""Family 10: the flow of the program."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1001",
        "unreachable",
        "warning",
        "commands behind STOP are never reached",
        "STOP ends the program. What follows looks as if it ran, and doesn't.",
        "P0010 STOP\nP0020 MOVEJ HOME [5] (s)",
        "P0010 MOVEJ HOME [5] (s)\nP0020 STOP",
    ),
)
