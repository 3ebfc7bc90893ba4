"""Findings of family 10: the flow of the program."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1001",
        "unreachable",
        "warning",
        "commands after STOP are never reached",
        "STOP ends the program. The commands after STOP are never executed, although they look like a part "
        "of the program.",
        "P0010 STOP\nP0020 MOVEJ HOME [5] (s)",
        "P0010 MOVEJ HOME [5] (s)\nP0020 STOP",
        tag="unneeded",
    ),
    Finding(
        "Y1002",
        "ways-end-apart",
        "error",
        "the branches of a WHEN end at different joint positions",
        "The branch is chosen only at run time, but the motion after END is planned once, from one joint "
        "position. So both branches must end at the same joint position. Without an ELSE, the branch must "
        "end at the joint position at which the WHEN began.",
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
        "a WAIT for an input has no time limit",
        "If the input never gets the expected value, the robot waits for ever. With a time limit, the run "
        "ends with an error that names the input.",
        "INPUT DOOR M11\nP0010 WAIT DOOR ON",
        "INPUT DOOR M11\nP0010 WAIT DOOR ON [30] (s)",
    ),
    Finding(
        "Y1004",
        "too-many-commands",
        "error",
        "the program has more than a million commands, or 200,000 passes of loops, counted with all "
        "repetitions and calls",
        "Loops and calls are expanded before the robot moves, so that every motion is checked. The commands "
        "are counted before that. The finding is at the loop or CALL that exceeds the limit. To repeat a "
        "program without end, use yarc run --loop.",
        "REPEAT 2000000\n  P0010 WAIT [1] (s)\nEND",
        "REPEAT 20\n  P0010 WAIT [1] (s)\nEND",
    ),
    Finding(
        "Y1010",
        "blend-into-nothing",
        "note",
        "BLEND has no effect: the robot stops after this motion",
        "A blend joins two motions without a stop. The robot nevertheless stops exactly at the end of a "
        "motion if a WAIT, a HOLD, a STOP, a WHEN, a motion of length 0 or the end of the program follows. "
        "A SET between two motions doesn't prevent their blend.",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) BLEND 2\nP0020 WAIT [1] (s)",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP0020 WAIT [1] (s)",
        needs="place",
    ),
)
