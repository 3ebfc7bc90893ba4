"""Findings of family 06: limits and time."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0601",
        "time-too-short",
        "error",
        "the motion would break a limit in this time",
        "Velocity, acceleration, jerk and motor speed have limits. The message names the joint, the place "
        "and the excess, and the shortest time that works: it is computed for the curve that the "
        "controller executes, and was tried.",
        "P0010 MOVEJ 90 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ 90 0 0 0 0 0 [MIN] (deg)",
        sort="time",
    ),
    Finding(
        "Y0602",
        "tolerance-not-held",
        "error",
        "the path can't be held within the tolerance",
        "The controller runs a spline with segments of one duration. Shorter segments follow the path "
        "better, but the controller needs time to calculate each one, and `--tm` may fix the duration.",
    ),
    Finding(
        "Y0603",
        "no-motion",
        "warning",
        "the motion goes nowhere",
        "The robot already stands at the target. The motion time is spent at rest.",
        "P0010 MOVEJ HOME [5] (s)",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0604",
        "motion-too-long",
        "error",
        "the motion has more segments than are planned",
        "Near a singularity the shortest time of a straight motion grows without bound. A motion of hours "
        "most likely has its time in the wrong unit.",
        "P0010 MOVEJ 10 0 0 0 0 0 [600] (deg,min)",
        "P0010 MOVEJ 10 0 0 0 0 0 [10] (deg,min)",
        sort="time",
    ),
    Finding(
        "Y0605",
        "speed-not-held",
        "error",
        "the moving frame can't go at this speed",
        "[V ..] is the speed that the moving frame keeps between its ramps. The message names the joint "
        "that can't follow, or says that the path is too short to reach the speed; the help names the "
        "highest speed that works.",
        "P0010 MOVEL {TCP} 0 1174.4 1000 0 0 0 [V 5000] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1000 0 0 0 [V 100] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0606",
        "blend-too-large",
        "error",
        "a blend takes more than half of a motion",
        "BLEND is the distance from the end of a command within which its path may be left. It may be at "
        "most half of each motion, because the other half belongs to the next corner.",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 500\n"
        "P0020 MOVEL {TCP} 100 1174.4 1100 0 0 0 [4] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 10\n"
        "P0020 MOVEL {TCP} 100 1174.4 1100 0 0 0 [4] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0607",
        "not-tangent",
        "error",
        "BLEND 0 between paths that meet at an angle",
        "With BLEND 0 the robot stays on the path, so both motions need the same direction at the corner. "
        "For an angle give the distance by which the corner may be cut.",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 0\n"
        "P0020 MOVEL {TCP} 100 1174.4 1100 0 0 0 [4] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 0\n"
        "P0020 MOVEL {TCP} 0 1174.4 1000 0 0 0 [4] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0608",
        "stops-at-corner",
        "note",
        "the limits leave no room for a blend",
        "Moving through a corner needs acceleration. If times or limits leave none, the robot stops there "
        "as without BLEND.",
    ),
    Finding(
        "Y0609",
        "time-off-the-grid",
        "warning",
        "a time can't be met exactly between motions without a stop",
        "Motions that flow into each other share one segment time, and each of their times has to be an "
        "integer number of segments. If no segment time fits all of them, the times between are rounded to "
        "the nearest segment; the total is exact.",
    ),
    Finding(
        "Y0610",
        "speed-not-reached",
        "warning",
        "a motion is too short to reach its speed",
        "[V ..] gives a speed, and speeding up and slowing down takes a part of the path. If the path is "
        "too short for this, the moving frame moves as fast as the limits allow.",
        "P0010 DMOVE {TCP} 0 0 -6 0 0 0 [V 500] (mm,deg,s) {B}",
        "P0010 DMOVE {TCP} 0 0 -60 0 0 0 [V 50] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0614",
        "no-law-found",
        "error",
        "no time-optimal law is found along the path",
        "_TOPP searches the fastest law numerically along the path. If joints have to turn far over a very "
        "short part of the path, as near a singularity, the search can fail; the message names the place. "
        "The other laws need no search.",
    ),
    Finding(
        "Y0615",
        "table-begins-elsewhere",
        "error",
        "a timetable doesn't begin where the robot stands",
        "A row at time 0 is the start of the motion. The robot is elsewhere at that time, and would have "
        "to jump there.",
    ),
    Finding(
        "Y0616",
        "timetable-too-fast",
        "error",
        "a timetable breaks a limit",
        "The times, velocities and accelerations of a timetable decide how fast every joint goes. The "
        "message names the joint or motor, the time and the excess, and the smallest factor of STRETCH "
        "that works: it was tried.",
        "P0010 MOVEJ_TIMED 90 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ_TIMED 90 0 0 0 0 0 [1] (deg,s) STRETCH 3",
    ),
    Finding(
        "Y0617",
        "timetable-not-held",
        "error",
        "a timetable can't be held within the tolerance",
        "The controller runs a spline with segments of one duration. If the path of a timetable bends more "
        "sharply than the shortest segments can follow, a joint deviates by more than TOL allows. The "
        "usual cause are velocities and accelerations that don't fit the positions.",
    ),
)
