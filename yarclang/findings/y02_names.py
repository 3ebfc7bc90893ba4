"""Findings of family 02: names."""

from yarclang.findings.finding import Finding, Follows

FINDINGS = (
    Finding(
        "Y0201",
        "duplicate-index",
        "error",
        "two commands have the same index",
        "A log or a message that names the index would mean two commands. P1 is P0001.",
        "P0010 MOVEJ HOME [5] (s)\nP10 STOP",
        "P0010 MOVEJ HOME [5] (s)\nP0020 STOP",
        follows=(Follows("Y0113", "above"),),
    ),
    Finding(
        "Y0202",
        "unknown-command",
        "error",
        "no command has this name",
        "The name of a command is MOTION[_TARGET][_AVOID][_PROFILE].",
        "P0010 MOVEK HOME [5] (s)",
        "P0010 MOVEJ HOME [5] (s)",
        hides="names",
    ),
    Finding(
        "Y0203",
        "unknown-suffix",
        "error",
        "the command doesn't take this suffix",
        "A target suffix (_RPY, _QUAT) gives the kind of the values, a profile suffix the law of motion; "
        "the target comes first.",
        "P0010 MOVEJ_LSPB_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_RPY_LSPB {TCP} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0204",
        "old-name",
        "warning",
        "a name of the first public release",
        "Programs of the first release are accepted (MOVJ, MOVL, DMOVJ, DMOV; frames {t}, {tool}, "
        "{root}). The names of today have the same meaning.",
        "P0010 MOVJ_LSPB HOME [5] (s)",
        "P0010 MOVEJ_LSPB HOME [5] (s)",
        tag="outdated",
    ),
    Finding(
        "Y0205",
        "unknown-joint-position",
        "error",
        "no joint position has this name",
        "A name among the values stands for a joint position: HOME, or another that the robot declares.",
        "P0010 MOVEJ HOEM [5] (s)",
        "P0010 MOVEJ HOME [5] (s)",
        needs="name",
        hides="names",
    ),
    Finding(
        "Y0206",
        "declared-twice",
        "error",
        "a declaration that is allowed once stands twice",
        "DEFAULT, START and ROBOT hold for the whole file. A second declaration would change the meaning "
        "of the lines above it.",
        "DEFAULT (mm,deg,s)\nDEFAULT (m,rad,s)\nP0010 STOP",
        "DEFAULT (mm,deg,s)\nP0010 STOP",
        follows=(Follows("Y0116", "here"),),
    ),
    Finding(
        "Y0208",
        "declaration-too-late",
        "error",
        "a declaration stands after the first command",
        "DEFAULT, START and ROBOT come before the first command, so that no line depends on a line below it.",
        "P0010 STOP\nDEFAULT (mm,deg,s)",
        "DEFAULT (mm,deg,s)\nP0010 STOP",
        follows=(Follows("Y0202", "above"),),
    ),
    Finding(
        "Y0209",
        "name-of-another-kind",
        "error",
        "the name means something else",
        "A name is one thing: a number, a joint position, an input, an output, a SUB or a module. Frames "
        "have names of their own.",
        "LET PARK = 5\nP0010 MOVEJ PARK [5] (deg,s)",
        "JOINTS PARK 0 0 0 0 20 0 (deg)\nP0010 MOVEJ PARK [5] (s)",
    ),
    Finding(
        "Y0210",
        "unknown-name",
        "error",
        "nothing of this kind has that name here",
        "A name is known from its declaration to the end of its block or file. A SUB sees its parameters "
        "and what its file declared before it, not what its caller knows. A module's names have its own in "
        "front: PALLET.GRID.",
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
        "The words of the language, P with digits, and the frames {B}, {FLANGE} and {TCP} already have a "
        "meaning.",
        "LET WAIT = 5\nP0010 STOP",
        "LET PAUSE = 5\nP0010 STOP",
    ),
    Finding(
        "Y0212",
        "recursion",
        "error",
        "a SUB calls itself",
        "Calls are carried out before the robot moves, so that every motion is known. A SUB that calls "
        "itself, or is called by what it calls, would never end.",
        "SUB AGAIN\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\n  P0020 CALL AGAIN\nEND\nP0030 CALL AGAIN",
        "SUB STEP\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND\nREPEAT 10\n  P0020 CALL STEP\nEND",
    ),
    Finding(
        "Y0213",
        "no-module",
        "error",
        "the module can't be used",
        "USE names a file beside the program, or one of the standard library, without its ending. Modules "
        "may use each other, but not in a circle.",
        "USE PALETT\nP0010 STOP",
        "USE PALLET\nP0010 STOP",
        hides="module",
    ),
    Finding(
        "Y0214",
        "hides-joint-position",
        "warning",
        "a name hides a joint position of the robot",
        "After this line the name has the new meaning, and MOVEJ can't go to the robot's joint position by "
        "that name. JOINTS may give the name another joint position.",
        "LET HOME = 5\nP0010 STOP",
        "LET SPAN = 5\nP0010 STOP",
    ),
    Finding(
        "Y0217",
        "unknown-body",
        "error",
        "ALLOW names a body that isn't there",
        "ALLOW takes the names of two bodies: links and mounted tools of the robot that have shapes, "
        "obstacles and parts of the cell. A body that isn't there would allow nothing.",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_9",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_6",
    ),
)
