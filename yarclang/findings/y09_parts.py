"""Findings of family 09, continued: parts that grippers take and put down."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0940",
        "grips-nothing",
        "warning",
        "a gripper closes without a part in reach",
        "A gripper takes the part that is nearest to the origin of the gripper's frame, if this part is "
        "within the gripper's reach. Here, no part is within reach: the program moves the gripper to a "
        "wrong place, the cell.toml gives a wrong place for the part, or all parts of this kind have been "
        "taken. From here on, the proof assumes that the gripper is empty. If it holds a part in reality, "
        "nothing is proved about that part.",
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
        "with another part. On its way down the part may touch the body under it, so the overlap is "
        "reported only when the gripper opens.",
        "P0030 MOVEL {GRIPPER} 0 0 -20 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF      ! 20 mm too low",
        "P0030 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF",
    ),
    Finding(
        "Y0943",
        "let-go-in-the-air",
        "warning",
        "a part is released without support",
        "When the gripper opens, no body supports the part: each one is farther away than 5 mm plus its "
        "margin. The part will fall, but all later motions are proved as if it stayed where it was "
        "released.",
        "P0030 MOVEL {GRIPPER} 0 0 60 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF",
        "P0030 MOVEL {GRIPPER} 0 0 0 0 0 0 [1] (mm,deg,s) {TABLE}\nP0040 SET GRIP OFF",
    ),
    Finding(
        "Y0944",
        "grips-while-moving",
        "error",
        "a gripper closes or opens while the robot moves",
        "With BLEND, the motions before and after the SET flow into each other, and the output is set in "
        "the middle of the corner. A part must be taken and put down at rest, because its place is known "
        "only then.",
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
        "after the WHENs, too many combinations of parts could be in the grippers",
        "If one branch of a WHEN takes a part and the other branch doesn't, all later motions are proved "
        "twice: with the part and without it. Each such part doubles the number of combinations, so at most "
        "five of them are allowed at a time.",
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
        "At the start of the program, the part overlaps with a body by more than a millimetre, or it has no "
        "support: the nearest body is farther away than 5 mm plus the larger of both margins. Most likely "
        "the part's frame or xyz in the cell.toml is wrong, or its support is missing in the cell.toml. The "
        "finding is at the line that takes the part. For several parts of one kind, it is reported only "
        "once.",
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
        "When the gripper closes, a body of the robot overlaps with the part. A vacuum cup (its gripper has "
        "a sensor of kind `vacuum`) overlaps by more than 5 mm, or another body by more than half of the "
        "part's thickness plus 5 mm. A gripper may touch the part that it takes, so this isn't reported as "
        "a collision. If the overlap isn't intended, the frame of the part or of the gripper is wrong by "
        "about this depth.",
        "P0010 MOVEL {CUP} 0 0 -30 0 0 0 [1] (mm,deg,s) {TOP}\n"
        "P0020 SET GRIP ON      ! the cup is 30 mm in the box",
        "P0010 MOVEL {CUP} 0 0 0 0 0 0 [1] (mm,deg,s) {TOP}\nP0020 SET GRIP ON      ! the cup is on the box",
    ),
    Finding(
        "Y0948",
        "loop-moves-parts",
        "error",
        "a pass of a loop leaves parts in other places than it found them",
        "One pass of a loop is proved, and executed many times. The proof holds for every pass only if "
        "every pass begins with the parts in the same places. So at the end of a pass, a part that was "
        "taken must be back, or the next part of its kind must have come. A part that was put down must "
        "have been taken away by a machine (an output with `removes` in the cell.toml).",
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
        "The output of a gripper, or of a machine that takes parts away, determines where parts are, and "
        "all later motions are proved with the parts in these places. With a value that is known only at "
        "run time, the places of the parts would be unknown.",
        "REGISTER N 0..1\nOUTPUT GRIP M1\nP0010 SET GRIP = N",
        "REGISTER N 0..1\nOUTPUT GRIP M1\nWHEN N = 1\n  P0010 SET GRIP ON\nEND",
    ),
    Finding(
        "Y0950",
        "gripper-behind-search",
        "error",
        "a gripper acts at the end of a search",
        "In a cell with parts, the proof of a motion needs the place of every part, including the place of "
        "a carried part in its gripper. At the end of a search, the gripper would take the part at another "
        "place each time.",
    ),
    Finding(
        "Y0951",
        "another-tool",
        "error",
        "after a TOOL line, another tool is on the flange than the line names",
        "TOOL sets the output of the tool changer's lock. The lock takes a tool if the flange is at the "
        "tool's place: within the lock's reach (0.5 mm if the cell.toml gives none) and within 0.5 deg. All "
        "later motions are proved with the masses and bodies of the tool on the flange, so it must be the "
        "tool that the program names. If another tool is on the flange, put it back first.",
    ),
    Finding(
        "Y0952",
        "tool-put-elsewhere",
        "error",
        "a tool is put down beside its place, or with a part in its gripper",
        "When the changer unlocks a tool, the tool must be at its place, which [[tools]] of the cell.toml "
        "gives, to within the lock's reach. Anywhere else the tool would fall. "
        "Its gripper must be empty, because a part in it would stay in the rack with the tool.",
    ),
    Finding(
        "Y0953",
        "ways-with-other-tools",
        "error",
        "branches end with different tools on the flange",
        "After a WHEN, a CASE or a loop, the same tool must be on the flange, whichever branch was "
        "executed, because masses, bodies and frames of all later motions depend on the tool. In the branch "
        "that changes the tool, change it back at the end, or move the commands that need the new tool into "
        "this branch.",
    ),
    Finding(
        "Y0954",
        "tool-is-not-on",
        "error",
        "a frame or a gripper is used whose tool isn't on the flange",
        "A tool in the rack has frames of its own: the frame from which robot.toml describes the tool, and "
        "those under `frames` of its [[tools]] table. The robot has these frames only while the tool is on "
        "the flange. A joint motion needs the tool's frame only if a zone of the cell watches the tool or "
        "its tcp. The gripper of a tool (`tool` of its output) takes parts only while the tool is on the "
        "flange.",
    ),
)
