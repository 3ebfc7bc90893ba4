"""Findings of family 09: ways round obstacles."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0920",
        "way-round",
        "note",
        "a motion takes a detour around an obstacle",
        "The straight path of a motion with _AVOID isn't free, so the robot takes another path. The same "
        "program, cell and version always give the same path, but a change of the cell may change the path. "
        "For a MOVEJ_AVOID, the fix writes the path as MOVEJ_SPLINE, which stays unchanged. For a "
        "MOVEL_AVOID, the message lists the corner poses.",
        "P0010 MOVEJ_AVOID 60 0 0 0 0 0 [MIN] (deg)      ! a POST stands at 30 deg",
        "JOINTS P0010_VIA1 31.2 -42.5 12.07 0.4 -3.11 0 (deg)\n"
        "P0010 MOVEJ_SPLINE P0010_VIA1; 60 0 0 0 0 0 [MIN] (deg)",
    ),
    Finding(
        "Y0964",
        "legs-astray",
        "error",
        "the legs planned for a MOVEL_AVOID don't match the command",
        "The planner replaces a MOVEL_AVOID by several straight motions, its legs. Before the legs are "
        "proved, they are compared with the command: they must end at its goal, move its frame, and keep "
        "its options and its time. All other commands of the program must be unchanged. This is a fault of "
        "the planner, not of the program.",
    ),
    Finding(
        "Y0921",
        "blocked-at-start",
        "error",
        "the robot isn't free at the start of a motion with _AVOID",
        "At the start of the motion, two bodies already overlap or are closer than a margin, or a zone or a "
        "KEEP is violated, so no free path can begin there. The message names the bodies and their distance "
        "or depth of overlap, or the zone or KEEP.",
        "START INSIDE      ! the arm is in the TABLE there\nP0010 MOVEJ_AVOID 40 0 0 0 0 0 [5] (deg,s)",
        "START HOME\nP0010 MOVEJ_AVOID 40 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0922",
        "blocked-at-target",
        "error",
        "the robot isn't free at the target of a motion with _AVOID",
        "At the target of the motion, two bodies would overlap or be closer than a margin, or a zone or a "
        "KEEP would be violated, so no free path can end there. The message names the bodies and their "
        "distance or depth of overlap, or the zone or KEEP.",
        "P0010 MOVEJ_AVOID 30 0 0 0 0 0 [5] (deg,s)      ! a POST stands there",
        "P0010 MOVEJ_AVOID 60 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0923",
        "no-way-found",
        "error",
        "no free path was found",
        "Start and target are free, but the search found no path between them. The number of its tries is "
        "fixed, so that it gives the same answer on every machine. A path may still exist, for example "
        "through a narrow gap. The message says how far the search came, and which body or zone blocked it "
        'there. Only a message that begins with "no path exists" is a proof. Either a zone forbids all '
        "values of a joint between start and target, or a box-shaped zone stands between them and the arm "
        "can't reach past it. Both cases are checked before the search.",
        "P0010 MOVEJ_AVOID 90 0 0 0 0 0 [5] (deg,s)      ! behind a wall",
        "P0010 MOVEJ_AVOID 0 60 -80 0 0 0 [5] (deg,s)    ! over the wall\n"
        "P0020 MOVEJ_AVOID 90 0 0 0 0 0 [5] (deg,s)",
        sort="unreachable",
    ),
    Finding(
        "Y0924",
        "configuration-blocked",
        "warning",
        "the nearest configuration isn't free, or can't be reached, and another one is taken",
        "A pose can be reached in several configurations, and MOVEJ takes the nearest one. Here, bodies "
        "would collide in the nearest configuration, a zone would be violated there, or MOVEJ_AVOID found "
        "no path to it. So the arm takes an unusual configuration. The fix writes NEAR, which states that "
        "this configuration is intended.",
        "P0010 MOVEJ_RPY 900 0 400 180 0 0 [5]      ! with the elbow down it would be in the TABLE",
        "P0010 MOVEJ_RPY 900 0 400 180 0 0 [5] NEAR ELBOW_UP",
    ),
    Finding(
        "Y0925",
        "every-configuration-blocked",
        "error",
        "no configuration of a target is free",
        "In every configuration for this pose, bodies collide or a zone is violated. The message names the "
        "first few. For the first commands of a program, the help names a nearby pose that is free: the "
        "tool with its z axis reversed (often the frame is wrong), turned about its z axis in steps of 30 "
        "deg, or moved by 5 to 50 mm. Writing this pose is another motion, so this fix is applied only on "
        "request.",
        "P0010 MOVEJ_RPY 900 0 100 180 0 0 [5]      ! the TABLE is 200 mm high",
        "P0010 MOVEJ_RPY 900 0 250 180 0 0 [5]",
    ),
    Finding(
        "Y0926",
        "approach-blocked",
        "error",
        "there is no free path to the start of a program",
        "Before a run, the robot moves slowly from its position to the program's start: on the straight "
        "path if this path is free, otherwise around the obstacles. Here, the robot collides with a body at "
        "its position or at the program's start, or no free path was found from one to the other. A person "
        "who sees the robot has to move it.",
        "$ yarc run program.yarc      # the arm was left between two shelves",
        "$ yarc repl      # jog it into the open first",
    ),
    Finding(
        "Y0927",
        "approach-unchecked",
        "warning",
        "the approach to a controller text is planned without a cell",
        "A .pmc file contains the motions, but not the obstacles: these are in the program's cell. If the "
        "program isn't in the folder of the .pmc file and --cell isn't given, the approach is checked "
        "against limits and self-collision only, not against obstacles.",
        "$ yarc run program.pmc --approach",
        "$ yarc run program.pmc --approach --cell cell.toml",
    ),
)
