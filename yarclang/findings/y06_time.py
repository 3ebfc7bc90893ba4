"""Findings of family 06: limits and time."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0601",
        "time-too-short",
        "error",
        "the motion would break a limit in this time",
        "Velocity, acceleration, jerk and motor speed have limits. The message names the joint, the place "
        "and the excess. It also names the shortest time that works; this time was tried with the curve "
        "that the controller executes.",
        "P0010 MOVEJ 90 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ 90 0 0 0 0 0 [MIN] (deg)",
        sort="time",
    ),
    Finding(
        "Y0602",
        "tolerance-not-held",
        "error",
        "the path can't be held within the tolerance",
        "The controller runs a spline whose segments have one duration. Shorter segments follow the path "
        "better, but the controller needs time to calculate each segment, so their duration has a lower "
        "limit. Give the motion more time or a larger --tolerance. If `--tm` was given, try a smaller "
        "value: it is the longest segment time that yarcc may use.",
    ),
    Finding(
        "Y0603",
        "no-motion",
        "warning",
        "the motion goes nowhere",
        "The robot is already at the target. It stands still for the programmed time.",
        "P0010 MOVEJ HOME [5] (s)",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0604",
        "motion-too-long",
        "error",
        "the motion has too many segments",
        "A motion may have at most 100,000 segments. If it would take hours, its time is most likely in the "
        "wrong unit. If its time is [MIN], the path most likely passes too near a singularity, where the "
        "shortest time of a straight motion grows without bound.",
        "P0010 MOVEJ 10 0 0 0 0 0 [600] (deg,min)",
        "P0010 MOVEJ 10 0 0 0 0 0 [10] (deg,min)",
        sort="time",
    ),
    Finding(
        "Y0605",
        "speed-not-held",
        "error",
        "the moving frame can't reach this speed",
        "[V ..] is the speed of the moving frame between acceleration and deceleration. The message names "
        "the joint that can't follow, or says that the path is too short to reach the speed. The help names "
        "the highest speed that works.",
        "P0010 MOVEL {TCP} 0 1174.4 1000 0 0 0 [V 5000] (mm,deg,s) {B}",
        "P0010 MOVEL {TCP} 0 1174.4 1000 0 0 0 [V 100] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0606",
        "blend-too-large",
        "error",
        "a blend takes more than half of a motion",
        "BLEND is the distance from the end of a command within which the path may deviate. It may take at "
        "most half of the motion before the corner and half of the motion after it, because the other "
        "halves belong to the neighbouring corners.",
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
        "With BLEND 0 the robot stays exactly on both paths, so the paths must have the same direction "
        "where they meet. If they meet at an angle, give a distance within which the corner may be rounded.",
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
        "Moving through a corner needs acceleration. If the limits don't allow this acceleration in the "
        "given times, the robot stops at the corner, as it does without BLEND.",
    ),
    Finding(
        "Y0609",
        "time-off-the-grid",
        "warning",
        "the time of a motion that flows into the next one is rounded",
        "Motions that follow each other without a stop share one segment time, and each motion takes an "
        "integer number of segments. If no segment time fits the times of all motions, the times of single "
        "motions are rounded to an integer number of segments. The total time stays exact.",
    ),
    Finding(
        "Y0610",
        "speed-not-reached",
        "warning",
        "a motion is too short to reach its speed",
        "[V ..] gives a speed. Speeding up and slowing down take a part of the path. If the path is too "
        "short for this, the moving frame moves as fast as the limits allow.",
        "P0010 DMOVE {TCP} 0 0 -6 0 0 0 [V 500] (mm,deg,s) {B}",
        "P0010 DMOVE {TCP} 0 0 -60 0 0 0 [V 50] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0614",
        "no-law-found",
        "error",
        "no time-optimal motion is found along the path",
        "_TOPP searches numerically for the fastest motion along the path. The search can fail if joints "
        "have to turn far over a very short part of the path, as they do near a singularity. The message "
        "names the place. The other profiles need no search.",
    ),
    Finding(
        "Y0615",
        "table-begins-elsewhere",
        "error",
        "a timetable doesn't begin at the position of the robot",
        "A row at time 0 must be the position at which the motion starts. Here, the robot is at another "
        "position when the motion starts, so it would have to jump.",
    ),
    Finding(
        "Y0616",
        "timetable-too-fast",
        "error",
        "a timetable breaks a limit",
        "The times, velocities and accelerations of a timetable determine the speed of every joint. The "
        "message names the joint or motor, the time and the excess. It also names the smallest factor for "
        "STRETCH that works; this factor was tried.",
        "P0010 MOVEJ_TIMED 90 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ_TIMED 90 0 0 0 0 0 [1] (deg,s) STRETCH 3",
    ),
    Finding(
        "Y0617",
        "timetable-not-held",
        "error",
        "a timetable can't be held within the tolerance",
        "The controller runs a spline whose segments have one duration. If a timetable's path bends so "
        "sharply that even the shortest segments can't follow it, a joint deviates by more than TOL allows. "
        "The usual cause is velocities or accelerations that don't fit the positions.",
    ),
)
