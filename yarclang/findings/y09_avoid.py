"""Family 09: ways round obstacles."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0920",
        "way-round",
        "note",
        "a motion goes round something",
        "The straight way in joint space of a motion with _AVOID isn't free, so that another one was found. It is the same each time for the same program, cell "
        "and version; but a change of the cell may change it. The fix writes it as MOVEJ_SPLINE, which stays as it is.",
        "P0010 MOVEJ_AVOID 60 0 0 0 0 0 [MIN] (deg)      ! a POST stands at 30 deg",
        "JOINTS P0010_VIA1 31.2 -42.5 12.07 0.4 -3.11 0 (deg)\nP0010 MOVEJ_SPLINE P0010_VIA1; 60 0 0 0 0 0 [MIN] (deg)",
    ),
    Finding(
        "Y0921",
        "blocked-at-start",
        "error",
        "where a motion with _AVOID begins, the robot isn't free",
        "A way round can't begin inside of something: the message names both bodies and how deep, or the zone that isn't kept to.",
        "START INSIDE      ! the arm is in the TABLE there\nP0010 MOVEJ_AVOID 40 0 0 0 0 0 [5] (deg,s)",
        "START HOME\nP0010 MOVEJ_AVOID 40 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0922",
        "blocked-at-target",
        "error",
        "at the target of a motion with _AVOID the robot isn't free",
        "No way leads into something: the message names both bodies and how deep, or the zone that isn't kept to.",
        "P0010 MOVEJ_AVOID 30 0 0 0 0 0 [5] (deg,s)      ! a POST stands there",
        "P0010 MOVEJ_AVOID 60 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0923",
        "no-way-found",
        "error",
        "no way round was found",
        "Start and target are free, and the search has ended without a way between them. It ends by the number of its tries, so that it gives the same answer "
        "on every machine. That is no proof: there may be no way, or only one through a gap that is hard to find. The message says how far the search came, and which body or zone is in the way from there on. "
        'Only where the message begins with "there is no way" is it a proof: a zone forbids one joint alone what lies between start and target, or is a box between them that the arm cannot '
        "reach past; both are seen before anything is searched for.",
        "P0010 MOVEJ_AVOID 90 0 0 0 0 0 [5] (deg,s)      ! behind a wall",
        "P0010 MOVEJ_AVOID 0 60 -80 0 0 0 [5] (deg,s)    ! over the wall\nP0020 MOVEJ_AVOID 90 0 0 0 0 0 [5] (deg,s)",
        sort="unreachable",
    ),
    Finding(
        "Y0924",
        "configuration-blocked",
        "warning",
        "the nearest configuration isn't free, or no way leads there, and another one is taken",
        "A pose has several joint positions, and MOVEJ takes the nearest. Here a body would be in another one there, a zone wouldn't be kept to, or, with _AVOID, no way leads there. "
        "The arm goes elsewhere than by its habit: the fix writes NEAR, which says that it is meant.",
        "P0010 MOVEJ_RPY 900 0 400 180 0 0 [5]      ! with the elbow down it would be in the TABLE",
        "P0010 MOVEJ_RPY 900 0 400 180 0 0 [5] NEAR ELBOW_UP",
    ),
    Finding(
        "Y0925",
        "every-configuration-blocked",
        "error",
        "no configuration of a target is free",
        "Whatever joint position the arm takes for this pose, a body is in another one, or a zone isn't kept to. The message tells the first few. For the first commands of a program "
        "the help names what would be free: the tool with its z the other way round (often the frame is what is wrong), turned about its z in steps of 30 deg, or moved by 5 to 50 mm. "
        "It has a fix, which is made only on request, since it is another motion.",
        "P0010 MOVEJ_RPY 900 0 100 180 0 0 [5]      ! the TABLE is 200 mm high",
        "P0010 MOVEJ_RPY 900 0 250 180 0 0 [5]",
    ),
    Finding(
        "Y0926",
        "approach-blocked",
        "error",
        "there is no free way to where a program starts",
        "Before a run the robot goes slowly from where it stands to where the program starts, straight if that is free, else by a way round. Here it stands in "
        "something, the start is in something, or no way was found between: somebody has to move it with open eyes.",
        "$ yarc run program.yarc      # the arm was left between two shelves",
        "$ yarc repl      # jog it into the open first",
    ),
    Finding(
        "Y0927",
        "approach-unchecked",
        "warning",
        "the way to where a controller text starts is planned without a cell",
        "A .pmc says what the robot does, and not what is around it: that stands in its program's cell. Where the program isn't found beside it, and --cell names none, "
        "an approach keeps to the limits and off the robot itself, and knows of nothing else that it may run into.",
        "$ yarc run program.pmc --approach",
        "$ yarc run program.pmc --approach --cell cell.toml",
    ),
)
