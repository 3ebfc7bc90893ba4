"""Family 11: the controller. Y1101 to Y1149 are about its settings, Y1151 to Y1199 about the certificate."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1151",
        "text-unreadable",
        "error",
        "the controller's text isn't what yarcc emits",
        "The certificate is about the text that goes to the controller. Its reader accepts only the lines "
        "that yarcc writes, each in its place, so that no unchecked line can take effect. The text was "
        "changed, or cut short, or the emitter has an error.",
    ),
    Finding(
        "Y1152",
        "segment-time-not-kept",
        "error",
        "the controller can't keep this segment time",
        "The controller keeps TM in steps of 1/4096 ms, below 4096 ms, and must calculate a move within it. "
        "Another value would be rounded or clipped, and every velocity, acceleration and jerk would differ "
        "from the proved one.",
    ),
    Finding(
        "Y1153",
        "map-mismatch",
        "error",
        "the text's map doesn't fit the program",
        "The header names the move lines of every command. If header, moves and program disagree, the "
        "moves of one command would be checked against the path of another.",
    ),
    Finding(
        "Y1154",
        "wrong-start",
        "error",
        "the motion starts elsewhere than the program",
        "The controller draws the first spline from where the robot stands. From another place than the "
        "program's start, the motion begins with a jerk and off the path. A fixed program must therefore "
        "wait until each motor is near enough.",
    ),
    Finding(
        "Y1155",
        "no-rest-between-commands",
        "error",
        "a command doesn't end at rest",
        "Three equal points are a full stop. Without them, the next command begins with a velocity, and "
        "neither path is what was programmed.",
    ),
    Finding(
        "Y1156",
        "wrong-duration",
        "error",
        "a motion takes another time than programmed",
        "The number of segments times the segment time must be the programmed duration, within half a step "
        "of TM (1/8192 ms) per segment.",
    ),
    Finding(
        "Y1157",
        "joint-limit-in-text",
        "error",
        "the emitted motion breaks a joint limit",
        "On each segment the jerk is constant, so that the extremes of position, velocity, acceleration and "
        "jerk are known exactly. One of them is beyond the robot's limit.",
        sort="limits",
    ),
    Finding(
        "Y1158",
        "motor-limit-in-text",
        "error",
        "the emitted motion breaks a motor's speed limit",
        "A motor may follow several joints: its speed can be too high while each joint's is allowed. The "
        "controller would stop the motor with a following error, off the path.",
        sort="limits",
    ),
    Finding(
        "Y1159",
        "path-deviation",
        "error",
        "the emitted path can't be proved within the tolerance",
        "The proved bound of the distance between executed and programmed path is larger than the tolerance.",
        sort="tolerance",
    ),
    Finding(
        "Y1160",
        "wrong-end",
        "error",
        "a motion ends elsewhere than programmed",
        "The last control point of a command, taken through the arm's kinematics, isn't at the programmed "
        "goal.",
        sort="tolerance",
    ),
    Finding(
        "Y1161",
        "waypoint-not-reached",
        "error",
        "the joint way-points that a spline was planned through aren't the programmed ones",
        "A pose has several joint positions. The planner states the joint positions that it chose. The "
        "certificate checks that they are at the programmed poses; here it found that they aren't, or "
        "couldn't check them.",
        sort="tolerance",
    ),
    Finding(
        "Y1162",
        "not-streamed",
        "error",
        "only a program for the rotary buffer is streamed",
        "yarc run fills the controller's rotary buffer while the robot moves. A text that was compiled "
        "with --target prog is a program buffer: it is downloaded as a whole, and B1R runs it.",
    ),
    Finding(
        "Y1163",
        "made-for-another-robot",
        "error",
        "the controller's text was made for another robot, or for the robot as it was",
        "The header of the text names the robot and a fingerprint of its geometry, limits, actuation and "
        "controller settings. If any of them has changed since, nothing that was proved holds any more.",
    ),
    Finding(
        "Y1164",
        "no-such-command",
        "error",
        "a run can't begin at this index",
        "yarc run --from begins at a command, named by its index: a motion, or a WAIT, SET or HOLD before "
        "a motion. Elsewhere the robot's place isn't known.",
    ),
    Finding(
        "Y1165",
        "other-flow",
        "error",
        "the text's actions between motions differ from the program's",
        "Dwells, outputs, waits, and the branches of a WHEN must be in the text as in the program, each at "
        "rest. An output that is set during a motion, or a skipped wait, does harm that no check of the "
        "path shows.",
    ),
    Finding(
        "Y1166",
        "blend-left",
        "error",
        "a blend leaves the ball round the corner",
        "If a motion flows into the next one (BLEND 5), the moving frame may leave the programmed paths "
        "only within that distance of the corner, and turn by no more than both motions do there; "
        "between two joint motions the same holds for each joint. The bound that was proved is larger: "
        "for the emitted motion, or for a path that the motion leaves too early or joins too late.",
        sort="tolerance",
    ),
    Finding(
        "Y1167",
        "speed-not-kept",
        "error",
        "the moving frame doesn't keep its programmed speed",
        "With a speed ([V 250]) the moving frame goes at that speed, within 0.1 %, from the end of its "
        "first ramp to the beginning of its last, and never faster. With a ceiling ([V<=250]) it is never "
        "faster, within 0.1 %. The bounds that were proved for the emitted motion say otherwise.",
    ),
    Finding(
        "Y1169",
        "text-changed",
        "error",
        "the controller's text was changed after it was written",
        "The header has a SHA-256 of the whole text. The SHA-256 shows damage and edits, but is no "
        "signature. So the text is judged in spite of a wrong one, and this finding is reported only if "
        "no other finding is.",
    ),
    Finding(
        "Y1190",
        "guard-weakened",
        "error",
        "the guard doesn't cover the motion",
        "While a program is streamed, P8100 arms a PLC that holds the motion on its path as soon as fewer "
        "than I16 lines lie ahead. It must be armed before the first move, with marks that leave enough "
        "motion for the hold, and disarmed only when the last lines are in the buffer. Otherwise a host "
        "that dies lets the buffer run dry while the robot moves.",
    ),
    Finding(
        "Y1191",
        "assignment-refused",
        "error",
        "the text assigns a variable that isn't an output of the program",
        "A variable of the controller can be a limit, a gain, an address or a motor's register. A text "
        "assigns the outputs of its program, their safe values, and the marks and the flag of its buffer's "
        "guard, and nothing else.",
    ),
    Finding(
        "Y1192",
        "program-has-errors",
        "error",
        "the program beside a controller's text can't be compiled",
        "A text is proved against the program beside it. That program has errors, so nothing can be "
        "proved. Correct the program and compile it again.",
    ),
    Finding(
        "Y1193",
        "judged-without-program",
        "note",
        "a controller's text was judged without its program",
        "A text alone shows limits, collisions, the guard, and the places at which it rests. It can't "
        "show whether its path, its times, its outputs and the conditions of its waits are those of the "
        "program. If the program is beside the text, under the name in the text's header or the text's "
        "own name, it is compiled, and the text is proved against it. The finding is a warning if the "
        "text waits for inputs or sets outputs.",
    ),
    Finding(
        "Y1180",
        "clearances-disagree",
        "error",
        "two proofs of a clearance disagree",
        "The certificate proves twice that bodies stay apart: once by the search that also reports the "
        "smallest distance, and once by placements, supports and bounds of its own. The second proof has "
        "found a place where two bodies are nearer than the first one reported. One of them has an error, "
        "and nothing is written. Report it, with the program, the robot and the cell.",
    ),
    Finding(
        "Y1181",
        "zones-disagree",
        "error",
        "a body is beyond a zone's border, and the proof overlooked it",
        "Zones to stay in or out of are proved by a geometry that the planner uses as well. At the ends of "
        "all segments the certificate checks a second time, with placements and distances of its own. A "
        "body beyond a border there means an error in the proof, and nothing is written. Report it, with "
        "the program, the robot and the cell.",
    ),
    Finding(
        "Y1194",
        "kinematics-disagree",
        "error",
        "the kinematics of the judge and a second reading of the robot disagree",
        "The judge reads robot.toml and URDF with a reader of its own and computes poses and torques with "
        "formulas of its own. At some places of every motion it asks Pinocchio as well. It also follows by "
        "itself which tool is on the flange. Where two disagree, one of them has an error, and nothing is "
        "proved. Report it, with the robot's files.",
    ),
    Finding(
        "Y1196",
        "no-proof",
        "error",
        "no proof can be written for this text",
        "`yarcc --proof` writes a proof that `yarc verify` follows with a small checker of its own. There "
        "is none for texts that are downloaded into a program buffer, for kinds of controllers without "
        "such a checker, for an arm with a joint that turns and slides at once, and for a text that the "
        "checker doesn't follow: its bounds are a little wider than the certificate's, so that a motion "
        "that needs all of its tolerance may be refused. Compile without --proof, with a wider tolerance, "
        "or with shorter segments (--tm).",
    ),
)
