"""Findings of family 05: reach."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0501",
        "out-of-reach",
        "error",
        "the robot can't reach this pose",
        "No joint position brings the moving frame to this pose, not even one outside the joint limits. The "
        "message gives the distance by which the pose is missed.",
        "P0010 MOVEJ_RPY {TCP} 0 4000 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        sort="unreachable",
        is_explained=True,
    ),
    Finding(
        "Y0502",
        "joint-out-of-limits",
        "error",
        "a joint position is outside its limits",
        "The target needs a joint position outside the robot's limits. The message says by how much the "
        "joint would exceed its limit.",
        "P0010 MOVEJ 171 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ 169 0 0 0 0 0 [5] (deg,s)",
        is_explained=True,
    ),
    Finding(
        "Y0503",
        "path-leaves-workspace",
        "error",
        "the path between start and end leaves the workspace",
        "Start and end can be reached, but a part of the path between them can't. For example, a straight "
        "line may pass outside the reach, or too close to the robot's base axis.",
        sort="unreachable",
    ),
    Finding(
        "Y0504",
        "path-leaves-limits",
        "error",
        "a joint leaves its limits between start and end",
        "Start and end are within the limits, but between them the path takes a joint beyond a limit. A "
        "straight line can't change the arm's configuration, so it may need such a joint position. A spline "
        "may overshoot between its waypoints.",
        "P0010 MOVEJ_SPLINE 169 0 0 0 0 0; 169 60 0 0 0 0; 0 0 0 0 0 0 [30] (deg,s)",
        "P0010 MOVEJ_SPLINE 150 0 0 0 0 0; 150 60 0 0 0 0; 0 0 0 0 0 0 [30] (deg,s)",
    ),
    Finding(
        "Y0505",
        "spline-swings-out",
        "note",
        "a spline overshoots its waypoints",
        "Between its waypoints, a smooth curve can go beyond their range. The note names the joint and the "
        "amount. An additional waypoint reduces the overshoot.",
    ),
    Finding(
        "Y0508",
        "offset-out-of-reach",
        "warning",
        "an OFFSET can't be carried out for all shifts in its box",
        "The ranges of an OFFSET's registers form a box of possible shifts. `yarc check` plans and proves "
        "the lines of the OFFSET for all combinations of the smallest, middle and largest value of each "
        "register. The message names the first shift for which this fails, with the command and the reason. "
        "When the program runs, the actual shift is planned and proved before anything moves; if this "
        "fails, the lines of ELSE run. So this warning means that parts in some places would not be "
        "handled.",
    ),
    Finding(
        "Y0509",
        "offset-untried",
        "note",
        "not all shifts in the boxes of OFFSETs were tried",
        "The ranges of an OFFSET's registers form a box of possible shifts. `yarc check` tries at most 400 "
        "shifts in a program, the corners of all boxes first. When the program runs, each shift is planned "
        "and proved before the robot moves, even if it wasn't tried here.",
    ),
)
