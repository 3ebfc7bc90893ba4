"""Findings of family 10: the flow of the program."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1001",
        "unreachable",
        "warning",
        "commands after STOP are never reached",
        "STOP ends the program. The commands after STOP look as if they ran, but they don't.",
        "P0010 STOP\nP0020 MOVEJ HOME [5] (s)",
        "P0010 MOVEJ HOME [5] (s)\nP0020 STOP",
        tag="unneeded",
    ),
    Finding(
        "Y1002",
        "ways-end-apart",
        "error",
        "the ways of a WHEN end at different joint positions",
        "The branch is chosen only at run time. The motion after END is planned once, from one place: both "
        "branches must end there; without ELSE, the branch must end where the WHEN began.",
        "INPUT DOOR M11\nWHEN DOOR OFF\n  P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nEND",
        "INPUT DOOR M11\n"
        "WHEN DOOR OFF\n"
        "  P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\n"
        "  P0020 MOVEJ HOME [5] (s)\n"
        "END",
    ),
    Finding(
        "Y1003",
        "waits-for-ever",
        "warning",
        "a WAIT on an input has no time",
        "If the input never gets there, the robot stands until somebody looks. With a time, the run ends "
        "with an error that says which input was missing.",
        "INPUT DOOR M11\nP0010 WAIT DOOR ON",
        "INPUT DOOR M11\nP0010 WAIT DOOR ON [30] (s)",
    ),
    Finding(
        "Y1004",
        "too-many-commands",
        "error",
        "the program has more than a million commands, or 200,000 rounds of loops, when it is unrolled",
        "Loops and calls are carried out before the robot moves, so that every motion is checked. They are "
        "counted first: the finding is at the loop, or the CALL, with which there are too many commands, "
        "rounds, or declarations. To repeat a program without end, use yarc run --loop.",
        "REPEAT 2000000\n  P0010 WAIT [1] (s)\nEND",
        "REPEAT 20\n  P0010 WAIT [1] (s)\nEND",
    ),
    Finding(
        "Y1010",
        "blend-into-nothing",
        "note",
        "BLEND before a line at which the robot stops",
        "A blend leads from one motion into the next. Before WAIT, HOLD, STOP, a WHEN and the end, and "
        "before a motion of length 0, the robot stops exactly at the end of the motion. SET doesn't break "
        "a blend.",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) BLEND 2\nP0020 WAIT [1] (s)",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP0020 WAIT [1] (s)",
        needs="place",
    ),
)
