"""Family 06: limits and time."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0601",
        "time-too-short",
        "error",
        "the motion would break a limit in this time",
        "Velocity, acceleration, jerk and motor speed have limits. The message names the joint, the place and the excess, and "
        "the shortest time that works: it is computed for the very curve that the controller executes, and tried.",
        "P0010 MOVEJ 90 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ 90 0 0 0 0 0 [MIN] (deg)",
        sort="time",
    ),
    Finding(
        "Y0602",
        "tolerance-not-held",
        "error",
        "the path can't be held within the tolerance",
        "The controller runs a spline with segments of one duration. Shorter segments follow the path better, but it can't calculate "
        "segments of any shortness, and `--tm` asks for a certain one.",
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
        "Beside a singularity the shortest time of a straight motion grows beyond all bounds; and a motion of hours is most "
        "likely a time in the wrong unit.",
        "P0010 MOVEJ 10 0 0 0 0 0 [600] (deg,min)",
        "P0010 MOVEJ 10 0 0 0 0 0 [10] (deg,min)",
        sort="time",
    ),
    Finding(
        "Y0605",
        "speed-not-held",
        "error",
        "the moving frame can't go at this speed",
        "[V ..] is the speed that the moving frame keeps all along, but for the ramps. The message names the joint that can't "
        "follow, or says that the way is too short to reach the speed, and the help names the highest speed that works.",
        "P0010 MOVEL {TCP} 0 1174.4 1000 0 0 0 [V 5000] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1000 0 0 0 [V 100] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0606",
        "blend-too-large",
        "error",
        "a blend takes more than half of a motion",
        "BLEND says how far from the end of a command its path may be left. Beyond the middle of either motion the next corner begins.",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 500\nP0020 MOVEL {TCP} 100 1174.4 1100 0 0 0 [4] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 10\nP0020 MOVEL {TCP} 100 1174.4 1100 0 0 0 [4] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0607",
        "not-tangent",
        "error",
        "BLEND 0 between paths that meet at an angle",
        "Without leaving the path, the robot can only go on in the direction in which it comes. Another corner needs a distance by which it may be cut.",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 0\nP0020 MOVEL {TCP} 100 1174.4 1100 0 0 0 [4] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1100 0 0 0 [4] (mm,deg,s) {B} BLEND 0\nP0020 MOVEL {TCP} 0 1174.4 1000 0 0 0 [4] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0608",
        "stops-at-corner",
        "note",
        "the limits leave no room for a blend",
        "Flowing through a corner asks for acceleration of its own. Where times or limits leave none, the robot stops there as without BLEND.",
    ),
    Finding(
        "Y0609",
        "time-off-the-grid",
        "warning",
        "a time can't be met exactly between motions without a stop",
        "Motions that flow into each other share one segment time, and each of their times has to be a whole number of segments. "
        "Where no segment time does for all, the seams are rounded to the nearest one; the whole is exact.",
    ),
    Finding(
        "Y0610",
        "speed-not-reached",
        "warning",
        "a way is too short to get to its speed",
        "[V ..] asks for a speed, and the ramps to it and from it take some of the way. Where the limits leave no room for them, the moving "
        "frame goes as fast as it can.",
        "P0010 DMOVE {TCP} 0 0 -6 0 0 0 [V 500] (mm,deg,s) {B}",
        "P0010 DMOVE {TCP} 0 0 -60 0 0 0 [V 50] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0614",
        "no-law-found",
        "error",
        "no time-optimal law is found along the path",
        "_TOPP searches its law numerically, from place to place. Where a path is so jagged that joints have to turn by much in no way at all, "
        "as beside a singularity, the search can give up. The message names the place. The other laws need no search.",
    ),
    Finding(
        "Y0615",
        "table-begins-elsewhere",
        "error",
        "a timetable begins where the robot doesn't stand",
        "A row at time 0 says where the motion begins. The robot is somewhere else then, and would have to jump there.",
    ),
    Finding(
        "Y0616",
        "timetable-too-fast",
        "error",
        "a timetable breaks a limit",
        "The times, velocities and accelerations of a timetable decide how fast every joint goes. The message names the joint or motor, the time and the excess; the "
        "factor of STRETCH is the smallest that works: it was tried.",
        "P0010 MOVEJ_TIMED 90 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ_TIMED 90 0 0 0 0 0 [1] (deg,s) STRETCH 3",
    ),
    Finding(
        "Y0617",
        "timetable-not-held",
        "error",
        "a timetable can't be held within the tolerance",
        "The controller runs a spline with segments of one duration. Where the path of a timetable bends more sharply than the shortest segments can follow, a joint is farther from it than TOL "
        "allows. Velocities and accelerations that don't belong to the positions give such a path.",
    ),
)
