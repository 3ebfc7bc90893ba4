"""Findings of family 09: ways round obstacles."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0920",
        "way-round",
        "note",
        "a motion goes round something",
        "The straight path of a motion with _AVOID isn't free, so that another path was found. The same "
        "program, cell and version always give the same path; a change of the cell may change it. The fix "
        "writes the path of a MOVEJ_AVOID as MOVEJ_SPLINE, which stays unchanged; for a MOVEL_AVOID the "
        "message has the corners.",
        "P0010 MOVEJ_AVOID 60 0 0 0 0 0 [MIN] (deg)      ! a POST stands at 30 deg",
        "JOINTS P0010_VIA1 31.2 -42.5 12.07 0.4 -3.11 0 (deg)\n"
        "P0010 MOVEJ_SPLINE P0010_VIA1; 60 0 0 0 0 0 [MIN] (deg)",
    ),
    Finding(
        "Y0964",
        "legs-astray",
        "error",
        "the legs that were planned for a MOVEL_AVOID aren't legs of this command",
        "The planner replaces a MOVEL_AVOID by straight legs. Before they are proved, they are compared "
        "with the command: they must end at its goal, move its frame, keep its options and its time, and "
        "leave all other commands as they are. This is a fault of the planner, not of the program.",
    ),
    Finding(
        "Y0921",
        "blocked-at-start",
        "error",
        "the robot isn't free at the start of a motion with _AVOID",
        "A path can't begin inside of a body: the message names both bodies and the depth, or the zone "
        "that is violated.",
        "START INSIDE      ! the arm is in the TABLE there\nP0010 MOVEJ_AVOID 40 0 0 0 0 0 [5] (deg,s)",
        "START HOME\nP0010 MOVEJ_AVOID 40 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0922",
        "blocked-at-target",
        "error",
        "the robot isn't free at the target of a motion with _AVOID",
        "No free path ends inside of a body: the message names both bodies and the depth, or the zone that "
        "is violated.",
        "P0010 MOVEJ_AVOID 30 0 0 0 0 0 [5] (deg,s)      ! a POST stands there",
        "P0010 MOVEJ_AVOID 60 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0923",
        "no-way-found",
        "error",
        "no way round was found",
        "Start and target are free, but the search found no path between them. The number of its tries is "
        "fixed, so that it gives the same answer on every machine. This proves nothing: a path through a "
        "narrow gap may exist. The message says how far the search came, and which body or zone blocks it "
        'from there on. A message that begins with "there is no way" is a proof: a zone forbids a joint the '
        "range between start and target, or is a box between them that the arm cannot reach past. Both are "
        "checked before the search.",
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
        "A pose has several joint positions, and MOVEJ takes the nearest. Here bodies would collide in the "
        "nearest one, a zone would be violated, or, with _AVOID, no path leads there. The arm takes an "
        "unusual configuration: the fix writes NEAR, which states that it is meant.",
        "P0010 MOVEJ_RPY 900 0 400 180 0 0 [5]      ! with the elbow down it would be in the TABLE",
        "P0010 MOVEJ_RPY 900 0 400 180 0 0 [5] NEAR ELBOW_UP",
    ),
    Finding(
        "Y0925",
        "every-configuration-blocked",
        "error",
        "no configuration of a target is free",
        "In every joint position for this pose, bodies collide or a zone is violated. The message names "
        "the first few. For the first commands of a program the help names a nearby pose that is free: the "
        "tool with its z reversed (often the frame is wrong), turned about its z in steps of 30 deg, or "
        "moved by 5 to 50 mm. Its fix is applied only on request, since it is another motion.",
        "P0010 MOVEJ_RPY 900 0 100 180 0 0 [5]      ! the TABLE is 200 mm high",
        "P0010 MOVEJ_RPY 900 0 250 180 0 0 [5]",
    ),
    Finding(
        "Y0926",
        "approach-blocked",
        "error",
        "there is no free path to the start of a program",
        "Before a run the robot goes slowly from where it stands to where the program starts, straight if "
        "that is free, else round the obstacles. Here the robot or the start collides with a body, or no "
        "path was found between them: a person who sees the robot has to move it.",
        "$ yarc run program.yarc      # the arm was left between two shelves",
        "$ yarc repl      # jog it into the open first",
    ),
    Finding(
        "Y0927",
        "approach-unchecked",
        "warning",
        "the approach to a controller text is planned without a cell",
        "A .pmc contains the motions, but not the obstacles: these are in the program's cell. If the "
        "program isn't found beside it, and --cell names no cell, the approach is checked against limits "
        "and self-collision only, not against obstacles.",
        "$ yarc run program.pmc --approach",
        "$ yarc run program.pmc --approach --cell cell.toml",
    ),
)
