"""Findings of family 05: reach."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0501",
        "out-of-reach",
        "error",
        "the robot can't reach this pose",
        "No joint position, whatever the limits, brings the moving frame to this pose. The message gives "
        "the distance by which the frame misses the pose.",
        "P0010 MOVEJ_RPY {TCP} 0 4000 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        sort="unreachable",
        is_explained=True,
    ),
    Finding(
        "Y0502",
        "joint-out-of-limits",
        "error",
        "a joint would be out of its limits",
        "The target needs a joint position outside the limits of the robot. The message gives the excess.",
        "P0010 MOVEJ 171 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ 169 0 0 0 0 0 [5] (deg,s)",
        is_explained=True,
    ),
    Finding(
        "Y0503",
        "path-leaves-workspace",
        "error",
        "the path between start and end leaves the workspace",
        "Start and end can be reached, but a part of the path between them can't: a straight line may pass "
        "outside the reach, or too near to the robot's own axis.",
        sort="unreachable",
    ),
    Finding(
        "Y0504",
        "path-leaves-limits",
        "error",
        "a joint leaves its limits between start and end",
        "Start and end are within the limits, but the path between takes a joint beyond them: a straight "
        "line because the configuration is kept, a spline because it swings between its way-points.",
        "P0010 MOVEJ_SPLINE 169 0 0 0 0 0; 169 60 0 0 0 0; 0 0 0 0 0 0 [30] (deg,s)",
        "P0010 MOVEJ_SPLINE 150 0 0 0 0 0; 150 60 0 0 0 0; 0 0 0 0 0 0 [30] (deg,s)",
    ),
    Finding(
        "Y0505",
        "spline-swings-out",
        "note",
        "a spline swings beyond its way-points",
        "A smooth curve through way-points can leave the range that they span. The note names the joint "
        "and the amount; another way-point between two of them reduces the swing.",
    ),
    Finding(
        "Y0508",
        "offset-out-of-reach",
        "warning",
        "an OFFSET can't be carried out everywhere in its box",
        "`yarc check` plans and proves the lines of an OFFSET at the corners of its box, in the middles of "
        "its edges and on a grid, and names the first place where it fails, with the command and the "
        "reason. When the program runs, a place is planned and proved before anything moves, and refused "
        "into the ELSE: so this is about parts that stay where they are.",
    ),
    Finding(
        "Y0509",
        "offset-untried",
        "note",
        "not all places in the boxes of OFFSETs were tried",
        "`yarc check` tries at most 400 places of a program, the corners of all boxes first. What wasn't "
        "tried is planned and proved when the program runs, as every place is.",
    ),
)
