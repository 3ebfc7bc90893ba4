"""Findings of family 09, continued: parts that grippers take and put down."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0940",
        "grips-nothing",
        "warning",
        "a gripper closes without a part in reach",
        "A gripper takes the part that is nearest to the origin of its frame, if that is within its reach. "
        "Here there is none: the program leads the gripper elsewhere, the cell.toml has the part "
        "elsewhere, or all parts of the kind have been taken. The robot carries nothing from here on, and "
        "nothing is proved about a part that it holds in reality.",
        "P0010 MOVEL {GRIPPER} 0 0 100 0 0 0 [1] (mm,deg,s) {BOX}\n"
        "P0020 SET GRIP ON      ! the box lies 100 mm below",
        "P0010 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {BOX}\nP0020 SET GRIP ON",
    ),
    Finding(
        "Y0941",
        "never-put-down",
        "warning",
        "a part is taken and never put down",
        "At the end of the program a gripper still holds the part. A program that is compiled by itself "
        "begins with all parts as in cell.toml; in a session (`yarc repl`, `serve`) the next program "
        "begins with the part in the gripper.",
        "P0020 SET GRIP ON\nP0030 MOVEJ READY [50%]",
        "P0020 SET GRIP ON\nP0030 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {PRESS}\nP0040 SET GRIP OFF",
    ),
    Finding(
        "Y0942",
        "put-into-something",
        "error",
        "a part is put into a body",
        "When the gripper opens, the part overlaps by more than a millimetre with a body of the cell, or "
        "with a part that lies there. On its way down the part may touch the body under it, so the "
        "overlap is reported only here.",
        "P0030 MOVEL {GRIPPER} 0 0 -20 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF      ! 20 mm too low",
        "P0030 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF",
    ),
    Finding(
        "Y0943",
        "let-go-in-the-air",
        "warning",
        "a part is released without support",
        "Where the gripper opens, no body is within 5 mm of the part (and the margin of that body). The "
        "part will fall; the proof goes on as if it stayed at the place of its release.",
        "P0030 MOVEL {GRIPPER} 0 0 60 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF",
        "P0030 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF",
    ),
    Finding(
        "Y0944",
        "grips-while-moving",
        "error",
        "a gripper closes or opens while the robot moves",
        "With BLEND, the motions before and after the SET flow into each other, and the output is set in "
        "the middle of the corner. A part is taken or put down at rest: only then is its place known.",
        "P0010 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {BOX} BLEND 5\n"
        "P0020 SET GRIP ON\n"
        "P0030 MOVEL {GRIPPER} 0 0 100 0 0 0 [1] (mm,deg,s) {BOX}",
        "P0010 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {BOX}\n"
        "P0020 SET GRIP ON\n"
        "P0030 MOVEL {GRIPPER} 0 0 100 0 0 0 [1] (mm,deg,s) {BOX}",
    ),
    Finding(
        "Y0945",
        "unsure-what-is-held",
        "error",
        "too many combinations of held parts after WHENs",
        "If one way of a WHEN takes a part and the other way doesn't, all later motions are proved with "
        "the part and without it. More than five such parts at once would give too many combinations.",
        "WHEN A ON\n"
        "  P0010 CALL PICKPLACE.PICK {GRIPPER} {BOX_A} 100 GRIP_A 1\n"
        "END      ! and so on, for six grippers",
        "WHEN A ON\n"
        "  P0010 CALL PICKPLACE.PICK {GRIPPER} {BOX_A} 100 GRIP_A 1\n"
        "  P0020 CALL PICKPLACE.PLACE {GRIPPER} {PRESS} 100 GRIP_A 1\n"
        "END",
    ),
    Finding(
        "Y0946",
        "starts-in-the-air",
        "warning",
        "a part has no support, or is inside of a body, at the start of the program",
        "At the start of the program no body is within 5 mm of the part (and the larger margin of both), "
        "or the part overlaps with a body by more than a millimetre. Most likely its frame or xyz in the "
        "cell.toml is wrong, or its support is missing there. It is reported at the line that takes the "
        "part; for parts of one kind only once.",
        "P0010 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {BOX}\n"
        "P0020 SET GRIP ON      ! cell.toml has the box 30 mm above its table",
        "P0010 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {BOX}\n"
        "P0020 SET GRIP ON      ! on its table in the cell.toml",
    ),
    Finding(
        "Y0947",
        "gripper-deep-in-part",
        "note",
        "a gripper closes deep in a part",
        "Where the gripper closes, a body of the robot overlaps with the part: the cup of a gripper with a "
        "sensor of kind `vacuum` by more than 5 mm, any other body by more than 5 mm beyond half of the "
        "part's thickness. A gripper may touch the part that it takes, so nothing is reported as a "
        "collision. If the overlap isn't meant, the frame of the part or of the gripper is wrong by as "
        "much.",
        "P0010 MOVEL {CUP} 0 0 -30 0 0 0 [1] (mm,deg,s) {TOP}\n"
        "P0020 SET GRIP ON      ! the cup is 30 mm in the box",
        "P0010 MOVEL {CUP} 0 0 0 0 0 0 [1] (mm,deg,s) {TOP}\nP0020 SET GRIP ON      ! the cup is on the box",
    ),
    Finding(
        "Y0948",
        "loop-moves-parts",
        "error",
        "a loop doesn't leave the parts as it found them",
        "One pass of a loop is proved, and executed many times. The proof holds for each pass only if "
        "every pass begins with the parts in the same places: a part that was taken is back, or the next "
        "of its kind has come, and a part that was put down was taken away by a machine (an output with "
        "`removes` in the cell.toml).",
        "LOOP\n"
        "  P0010 CALL PICKPLACE.PICK {GRIPPER} {BOX} 100 GRIP 1\n"
        "  P0020 CALL PICKPLACE.PLACE {GRIPPER} {TRAY} 100 GRIP 1\n"
        "UNTIL DONE ON",
        "REPEAT I 4\n"
        "  P0010 CALL PICKPLACE.PICK {GRIPPER} {BOX} 100 GRIP 1\n"
        "  P0020 CALL PICKPLACE.PLACE {GRIPPER} {TRAY} 100 GRIP 1\n"
        "END",
    ),
    Finding(
        "Y0949",
        "parts-moved-by-a-number",
        "error",
        "an output that moves parts gets a value that is computed at run time",
        "A gripper's output, or the output of a machine that takes parts away, determines where parts "
        "are, and all later motions are proved with the parts there. With a value that is known only at "
        "run time, the places of the parts would be unknown.",
        "REGISTER N 0..1\nOUTPUT GRIP M1\nP0010 SET GRIP = N",
        "REGISTER N 0..1\nOUTPUT GRIP M1\nWHEN N = 1\n  P0010 SET GRIP ON\nEND",
    ),
    Finding(
        "Y0950",
        "gripper-behind-search",
        "error",
        "a gripper acts at the end of a search",
        "In a cell with parts, the proof of each motion needs the places of all parts, also in the "
        "gripper. A part that is taken at the end of a search would have another place in the gripper each "
        "time.",
    ),
    Finding(
        "Y0951",
        "another-tool",
        "error",
        "TOOL names a tool that isn't on the flange after it",
        "TOOL sets the output of the tool changer's lock. The lock takes the tool at whose place the "
        "flange is: within the lock's reach (0.5 mm if the cell.toml gives none) and 0.5 deg. All later "
        "motions are proved with the masses and bodies of this tool, so it must be the tool that the "
        "program names. Another tool has to be put back first.",
    ),
    Finding(
        "Y0952",
        "tool-put-elsewhere",
        "error",
        "a tool is put down beside its place, or with a part in its gripper",
        "A tool that the changer unlocks stands in its place under [[tools]] of the cell.toml, exactly "
        "there: the flange must be within the lock's reach of it. Anywhere else it would fall. What its "
        "gripper holds would stay in the rack with it.",
    ),
    Finding(
        "Y0953",
        "ways-with-other-tools",
        "error",
        "ways of a program meet with different tools on the flange",
        "After a WHEN, a CASE or a loop, one tool is on the flange, whichever way was taken: masses, "
        "bodies and frames of all that follows depend on it. Change the tool back on the way that changes "
        "it, or put what needs the tool on that way.",
    ),
    Finding(
        "Y0954",
        "tool-is-not-on",
        "error",
        "a motion leads a frame of a tool that isn't on the flange, or its gripper closes",
        "A tool of the rack brings its frames along: the frame from which robot.toml describes it, and "
        "those under `frames` of its [[tools]] table. While another tool, or none, is on the flange, there "
        "is nothing at that frame. For a motion of the joints the frame matters only if zones of the cell "
        "watch the tool or its tcp. A gripper of a tool (`tool` of its output) takes parts only while the "
        "tool is on.",
    ),
)
