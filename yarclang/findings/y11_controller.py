"""Family 11: the controller. Y1101 to Y1149 are about its settings, Y1151 to Y1199 about the certificate."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1151",
        "text-unreadable",
        "error",
        "the controller's text isn't what yarcc emits",
        "The certificate is about the text that goes to the controller. The judge accepts only the lines "
        "that yarcc writes, each in its place, so that no unchecked line can take effect. Either the text "
        "was changed or cut short, or yarcc has an error.",
    ),
    Finding(
        "Y1152",
        "segment-time-not-kept",
        "error",
        "the controller can't execute this segment time",
        "The controller stores the segment time TM in steps of 1/4096 ms, below 4096 ms, and must calculate "
        "each move within one segment time. Another TM would be rounded or clipped, and every velocity, "
        "acceleration and jerk would differ from the proved one.",
    ),
    Finding(
        "Y1153",
        "map-mismatch",
        "error",
        "the text's map doesn't fit the program",
        "The text's header is a map: it names the move lines of every command. If header, moves and program "
        "disagree, the moves of one command would be checked against the path of another.",
    ),
    Finding(
        "Y1154",
        "wrong-start",
        "error",
        "the motion doesn't begin at the program's start",
        "The controller begins the first spline at the robot's position. If that isn't the program's start, "
        "the motion begins with a jolt and off the path. A text for a program buffer must therefore wait at "
        "its beginning until each motor is near enough to the start.",
    ),
    Finding(
        "Y1155",
        "no-rest-between-commands",
        "error",
        "a command doesn't end at rest",
        "In the controller's spline, three equal control points bring the robot to rest. If they are "
        "missing at the end of a command, the next command begins with a velocity other than 0, and both "
        "paths differ from the programmed ones.",
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
        "On each segment the jerk is constant, so the extreme values of position, velocity, acceleration "
        "and jerk can be computed exactly. One of them exceeds the robot's limit, or the percentage of it "
        "that the program allows ([50%], ACC).",
        sort="limits",
    ),
    Finding(
        "Y1158",
        "motor-limit-in-text",
        "error",
        "the emitted motion breaks a motor's speed limit",
        "A motor may drive several joints, so its speed can be too high although the speed of each joint is "
        "allowed. The controller would stop the motor with a following error, off the path. The speed "
        "may also exceed the percentage of its limit that the program allows ([50%]).",
        sort="limits",
    ),
    Finding(
        "Y1159",
        "path-deviation",
        "error",
        "the emitted path can't be proved within the tolerance",
        "The judge computes a bound of the distance between the executed and the programmed path. This "
        "bound is larger than the tolerance.",
        sort="tolerance",
    ),
    Finding(
        "Y1160",
        "wrong-end",
        "error",
        "a motion ends elsewhere than programmed",
        "The judge computes the pose of the moving frame from the last control point of the command. This "
        "pose isn't the programmed goal.",
        sort="tolerance",
    ),
    Finding(
        "Y1161",
        "waypoint-not-reached",
        "error",
        "the joint waypoints that a spline was planned through aren't the programmed ones",
        "A pose can be reached in several joint positions, and the planner states which ones it chose. The "
        "certificate checks that these joint positions are at the programmed poses. Here, it found that "
        "they aren't, or couldn't check them.",
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
        "the controller's text was made for another robot, or for an earlier state of this one",
        "The header of the text names the robot and a fingerprint of its geometry, limits, actuation and "
        "controller settings. If any of them has changed since, the proof doesn't hold any more.",
    ),
    Finding(
        "Y1164",
        "no-such-command",
        "error",
        "a run can't begin at this index",
        "yarc run --from begins at a command, named by its index: a motion, or a WAIT, SET or HOLD before "
        "a motion. At any other place the robot's position isn't known.",
    ),
    Finding(
        "Y1165",
        "other-flow",
        "error",
        "the text's actions between motions differ from the program's",
        "Dwells, outputs, waits, and the branches of a WHEN must be in the text as they are in the program, "
        "and the robot must be at rest at each of them. An output that is set during a motion, or a skipped "
        "wait, can do harm, but no check of the path would find it.",
    ),
    Finding(
        "Y1166",
        "blend-left",
        "error",
        "a blend leaves the allowed ball around the corner",
        "With BLEND 5, the moving frame may leave the programmed paths only within 5 mm of the corner. Its "
        "orientation may deviate by at most the sum of the rotations that both motions make within this "
        "distance. Between two joint motions, there is a limit for each joint instead. Here, the proved "
        "bound is larger: the emitted motion is too far from the corner, or it leaves the first path too "
        "early, or it joins the second path too late.",
        sort="tolerance",
    ),
    Finding(
        "Y1167",
        "speed-not-kept",
        "error",
        "the moving frame doesn't keep its programmed speed",
        "With a speed ([V 250]), the moving frame must move at this speed, within 0.1 %, from the end of "
        "the first ramp to the beginning of the last one, and never faster. With a ceiling ([V<=250]), it "
        "must never be faster, within 0.1 %. The proved bounds of the emitted motion violate this.",
    ),
    Finding(
        "Y1169",
        "text-changed",
        "error",
        "the controller's text was changed after it was written",
        "The header has a SHA-256 of the whole text. It reveals damage and edits, but isn't a signature. A "
        "text with a wrong SHA-256 is still checked completely, and this finding is reported only if the "
        "check finds nothing else.",
    ),
    Finding(
        "Y1190",
        "guard-weakened",
        "error",
        "the guard doesn't cover the motion",
        "While a program is streamed, P8100 arms a PLC, the guard. The guard holds the motion on its path "
        "as soon as fewer than I16 lines are left in the buffer. It must be armed before the first move, "
        "with values of I16 and I17 that leave enough motion for the hold. It must stay armed until after "
        "the last move, and enough lines must follow that disarm it. Otherwise, if the host fails, the "
        "buffer may run empty while the robot moves.",
    ),
    Finding(
        "Y1191",
        "assignment-refused",
        "error",
        "the text assigns a variable that isn't an output of the program",
        "A variable of the controller can be a limit, a gain, an address or a motor's register. So a text "
        "may assign only the outputs of its program, their safe values, and the guard's own variables, such "
        "as P8100, I16 and I17.",
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
        "Limits, collisions, the guard, and the places at which the robot rests can be checked with the "
        "text alone. Without the program, it can't be checked that the path, the times, the outputs and the "
        "conditions of waits are those of the program. If the program is in the folder of the text, under "
        "the name in the text's header or the text's own name, it is compiled, and the text is proved "
        "against it. The finding is a warning if the text waits for inputs or sets outputs.",
    ),
    Finding(
        "Y1180",
        "clearances-disagree",
        "error",
        "two proofs of a clearance disagree",
        "The certificate proves twice that bodies stay apart. The first proof also computes the smallest "
        "distance. The second proof computes the places of bodies and their distances with code of its own, "
        "and has found a place where two bodies are nearer than that distance. One of the proofs has an "
        "error, and nothing is written. Report it, with the program, the robot and the cell.",
    ),
    Finding(
        "Y1181",
        "zones-disagree",
        "error",
        "a body is beyond a zone's border, and the proof overlooked it",
        "The proof of zones to stay in or out of uses the same geometry code as the planner. So the "
        "certificate checks the ends of all segments a second time, with code of its own. There, a body is "
        "beyond a zone's border, so the proof has an error, and nothing is written. Report it, with the "
        "program, the robot and the cell.",
    ),
    Finding(
        "Y1194",
        "kinematics-disagree",
        "error",
        "the judge's kinematics disagree with a second computation",
        "The judge reads robot.toml and URDF with a reader of its own and computes poses and torques with "
        "formulas of its own. At some places of every motion it compares its results with Pinocchio's. It "
        "also determines independently which tool is on the flange. If two results disagree, one of them "
        "has an error, and nothing is proved. Report it, with the robot's files.",
    ),
    Finding(
        "Y1196",
        "no-proof",
        "error",
        "no proof can be written for this text",
        "`yarcc --proof` writes a proof that `yarc verify` can check with a small program of its own. No "
        "such proof is written for texts that are downloaded into a program buffer, for kinds of "
        "controllers that the small program doesn't know, and for an arm with a joint that turns and slides "
        "at once. A proof is also refused if the small program can't confirm the text. The bounds of the "
        "small program are a little wider than the certificate's, so a motion that needs all of its "
        "tolerance may fail. Compile without --proof, with a wider tolerance, or with shorter segments "
        "(--tm).",
    ),
)
