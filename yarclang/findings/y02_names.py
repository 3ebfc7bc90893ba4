"""Findings of family 02: names."""

from yarclang.findings.finding import Finding, Follows

FINDINGS = (
    Finding(
        "Y0201",
        "duplicate-index",
        "error",
        "two commands have the same index",
        "Logs and messages name a command by its index, so each index must be unique. P1 is the same index "
        "as P0001.",
        "P0010 MOVEJ HOME [5] (s)\nP10 STOP",
        "P0010 MOVEJ HOME [5] (s)\nP0020 STOP",
        follows=(Follows("Y0113", "above"),),
    ),
    Finding(
        "Y0202",
        "unknown-command",
        "error",
        "no command has this name",
        "The name of a motion command is MOTION[_TARGET][_AVOID][_PROFILE], for example MOVEJ, MOVEJ_RPY or "
        "MOVEJ_RPY_LSPB. The message names similar commands, if there are any.",
        "P0010 MOVEK HOME [5] (s)",
        "P0010 MOVEJ HOME [5] (s)",
        hides="names",
    ),
    Finding(
        "Y0203",
        "unknown-suffix",
        "error",
        "the command doesn't take this suffix",
        "A target suffix (_RPY, _QUAT) states which values follow. A profile suffix (such as _LSPB) chooses "
        "the motion profile, and comes last.",
        "P0010 MOVEJ_LSPB_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_RPY_LSPB {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0204",
        "old-name",
        "warning",
        "an old name from the first public release",
        "Programs of the first release are accepted (MOVJ, MOVL, DMOVJ, DMOV; frames {t}, {tool}, {root}). "
        "The new names have the same meaning.",
        "P0010 MOVJ_LSPB HOME [5] (s)",
        "P0010 MOVEJ_LSPB HOME [5] (s)",
        tag="outdated",
    ),
    Finding(
        "Y0205",
        "unknown-joint-position",
        "error",
        "no joint position has this name",
        "A name among the values must be a joint position: HOME, another one of the robot, or one that "
        "JOINTS declares.",
        "P0010 MOVEJ HOEM [5] (s)",
        "P0010 MOVEJ HOME [5] (s)",
        needs="name",
        hides="names",
    ),
    Finding(
        "Y0206",
        "declared-twice",
        "error",
        "a declaration that is allowed once is given twice",
        "DEFAULT, START, ROBOT and CELL apply to the whole file, and an ON line applies to one state of its "
        "input. A second such line would contradict the first.",
        "DEFAULT (mm,deg,s)\nDEFAULT (m,rad,s)\nP0010 STOP",
        "DEFAULT (mm,deg,s)\nP0010 STOP",
        follows=(Follows("Y0116", "here"),),
    ),
    Finding(
        "Y0208",
        "declaration-too-late",
        "error",
        "a declaration comes after the first command",
        "DEFAULT, START, ROBOT and CELL must come before the first command, so that no line depends on a "
        "line below it.",
        "P0010 STOP\nDEFAULT (mm,deg,s)",
        "DEFAULT (mm,deg,s)\nP0010 STOP",
        follows=(Follows("Y0202", "above"),),
    ),
    Finding(
        "Y0209",
        "name-of-another-kind",
        "error",
        "the name is of another kind",
        "Each name is of one kind: number, joint position, input, output, register, SUB or module. At this "
        "place, a name of another kind is needed. The names of frames are separate: a frame may have the "
        "same name as a number, for example.",
        "LET PARK = 5\nP0010 MOVEJ PARK [5] (deg,s)",
        "JOINTS PARK 0 0 0 0 20 0 (deg)\nP0010 MOVEJ PARK [5] (s)",
    ),
    Finding(
        "Y0210",
        "unknown-name",
        "error",
        "no such name is declared here",
        "A name is known from its declaration to the end of its block or file. A SUB can use its "
        "parameters and the names that its file declares before it, but not the names of its caller. Names "
        "of a module are written with the module's name: PALLET.GRID.",
        "LET PITCH = 10 (deg)\nP0010 DMOVEJ $PICTH 0 0 0 0 0 [5] (deg,s)",
        "LET PITCH = 10 (deg)\nP0010 DMOVEJ $PITCH 0 0 0 0 0 [5] (deg,s)",
        needs="name",
        hides="names",
    ),
    Finding(
        "Y0211",
        "not-to-be-declared",
        "error",
        "this name can't be declared",
        "The words of the language, P followed by digits, and the frames {B}, {FLANGE} and {TCP} can't be "
        "declared again.",
        "LET WAIT = 5\nP0010 STOP",
        "LET PAUSE = 5\nP0010 STOP",
    ),
    Finding(
        "Y0212",
        "recursion",
        "error",
        "a SUB calls itself",
        "All calls are resolved before the robot moves, so that every motion is known. A SUB that calls "
        "itself, directly or through another SUB, would never end.",
        "SUB AGAIN\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\n  P0020 CALL AGAIN\nEND\nP0030 CALL AGAIN",
        "SUB STEP\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND\nREPEAT 10\n  P0020 CALL STEP\nEND",
    ),
    Finding(
        "Y0213",
        "no-module",
        "error",
        "the module can't be used",
        "USE needs the name of a .yarc file in the program's folder, or of a module of the standard "
        "library, both without the ending. A module can't use itself, not even through other modules.",
        "USE PALETT\nP0010 STOP",
        "USE PALLET\nP0010 STOP",
        hides="module",
    ),
    Finding(
        "Y0214",
        "hides-joint-position",
        "warning",
        "a name hides a joint position of the robot",
        "From this line on, the name has the new meaning, and MOVEJ can no longer reach the robot's joint "
        "position by this name. Choose another name, or declare another joint position under this name with "
        "JOINTS, which is allowed without a warning.",
        "LET HOME = 5\nP0010 STOP",
        "LET SPAN = 5\nP0010 STOP",
    ),
    Finding(
        "Y0217",
        "unknown-body",
        "error",
        "ALLOW names an unknown body",
        "ALLOW takes the names of two bodies: links and mounted tools of the robot that have shapes, "
        "obstacles and parts of the cell. An ALLOW for an unknown body would have no effect.",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_9",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_6",
    ),
)
