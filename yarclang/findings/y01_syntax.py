"""Findings of family 01: the text itself."""

from yarclang.findings.finding import Finding, Follows

FINDINGS = (
    Finding(
        "Y0101",
        "unexpected-text",
        "error",
        "a part of the line is in the wrong place",
        "The seven parts of a command have one order: index, name, {moving frame}, values, [motion time], "
        "(units), {base frame}, then options. A line that can be read in two ways could move the arm in "
        "two ways, so the order isn't guessed.",
        "P0010 MOVEJ 0 0 0 0 0 0 (deg,s) [5]",
        "P0010 MOVEJ 0 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0102",
        "unclosed",
        "error",
        "a bracket or a text is not closed",
        "Frames stand in { }, the motion time in [ ], units in ( ), texts in quotes; each is closed in its "
        "own line.",
        "P0010 MOVEJ 0 0 0 0 0 0 [5 (deg,s)",
        "P0010 MOVEJ 0 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0103",
        "not-text",
        "error",
        "the file is not UTF-8 text",
        "A program is UTF-8 text (a byte order mark and CRLF line ends are fine). A control character or a "
        "byte that isn't UTF-8 means that this is another kind of file, or that the file was damaged.",
    ),
    Finding(
        "Y0104",
        "empty-program",
        "error",
        "the file has no command",
        "A program without a command moves nothing: most likely the file was cut off, or another one was "
        "meant.",
        "! nothing but a comment",
        "P0010 STOP",
    ),
    Finding(
        "Y0105",
        "missing-index",
        "error",
        "a command has no index",
        "Messages, logs and a start in the middle of the program name a command by its index. Only the "
        "live interpreter accepts commands without one.",
        "STOP",
        "P0010 STOP",
        follows=(Follows("Y0202", "here"),),
    ),
    Finding(
        "Y0106",
        "line-too-long",
        "error",
        "a line is longer than any program line",
        "Lines of more than 100,000 characters, and texts of more than 20,000,000, are no program: most "
        "likely a data file was given instead.",
    ),
    Finding(
        "Y0107",
        "file-not-accessible",
        "error",
        "the file can't be read or written",
        "The operating system refused the file; the message gives its reason. Folders, devices, named "
        "pipes and files of more than 20,000,000 bytes aren't read: a program is a file, or comes from "
        "standard input.",
    ),
    Finding(
        "Y0108",
        "controller-text",
        "error",
        "this is the controller's text, not a program",
        "A .pmc file is the text that yarcc makes of a program. Read as a program, it would give a "
        "finding for each line.",
    ),
    Finding(
        "Y0109",
        "unknown-function",
        "error",
        "no function has this name",
        "The functions of expressions are SQRT SIN COS TAN ATAN2 ABS MIN MAX FLOOR CEIL, and those that "
        "FUNC declares further up. Only functions and numbers can be followed by a bracket: a number's "
        "bracket holds its unit. A product is written with a `*`.",
        "P0010 MOVEJ $(SQR(900)) 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ $(SQRT(900)) 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0110",
        "function-arguments",
        "error",
        "the function takes another number of arguments",
        "ATAN2 takes two arguments, y and then x; MIN and MAX take two or more; a FUNC takes those of "
        "its declaration; all other functions take one. Commas separate arguments, so a decimal comma "
        "turns one number into two.",
        "P0010 MOVEJ $(ABS(0,5)) 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ $(ABS(0.5)) 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0111",
        "foreign-operator",
        "error",
        "an operator of another language",
        "The operators are OR, AND, NOT, = <> < <= > >=, + -, * / %, **. Operators of other languages may "
        "mean something else; and `!` starts a comment, so that the rest of the line would be lost.",
        "P0010 MOVEJ $(3^2) 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ $(3**2) 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0112",
        "too-deep",
        "error",
        "too many blocks, CALLs or brackets stand inside each other",
        "Blocks may be nested 100 deep, and so may operators, functions and brackets in one expression; "
        "nested CALLs, with the blocks around them, 150 deep. A deeper file was most likely written by a "
        "program that went wrong.",
    ),
    Finding(
        "Y0113",
        "missing-end",
        "error",
        "a block has no END",
        "SUB, REPEAT, IF, WHEN, CASE, WHILE, a WAIT with an ELSE and a LOOP without UNTIL each need their "
        "own END: without it nobody knows which commands are repeated, or depend on the condition.",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)\nEND",
        needs="end",
    ),
    Finding(
        "Y0114",
        "end-without-block",
        "error",
        "an END or ELSE belongs to no block",
        "END ends the innermost block that is open, and ELSE divides it. If no block is open, the first "
        "line of a block is missing, and commands would run unconditionally.",
        "P0010 MOVEJ HOME [5] (s)\nEND",
        "P0010 MOVEJ HOME [5] (s)",
        needs="block",
    ),
    Finding(
        "Y0115",
        "misplaced-else",
        "error",
        "a block has an ELSE that it can't have",
        "IF and WHEN have one ELSE each; SUB and REPEAT have none. For a third case write another IF after "
        "ELSE, with its own END.",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)\nELSE\n  P0020 MOVEJ HOME [5] (s)\nEND",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)\nEND\nP0020 MOVEJ HOME [5] (s)",
    ),
    Finding(
        "Y0116",
        "not-in-a-block",
        "error",
        "a block can't hold this line",
        "Blocks hold commands, FRAME, POSE, JOINTS, LET and blocks other than SUB. Declarations for the "
        "whole file stand outside of blocks: a loop or a condition would repeat them, or skip them.",
        "REPEAT 2\n  DEFAULT (deg,s)\n  P0010 DMOVEJ 5 0 0 0 0 0 [1]\nEND",
        "DEFAULT (deg,s)\nREPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1]\nEND",
    ),
    Finding(
        "Y0117",
        "surplus-index",
        "error",
        "a declaration has an index",
        "Only commands have an index: messages, logs and a start in the middle of the program name "
        "commands by it. A declaration moves nothing.",
        "P0010 LET A = 30\nP0020 MOVEJ $A 0 0 0 0 0 [5] (deg,s)",
        "LET A = 30\nP0010 MOVEJ $A 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0118",
        "foreign-character",
        "error",
        "a character that no program has",
        "Code is made of blanks, tabs and the printable characters of ASCII. A look-alike (a no-break "
        "space, a minus sign from a text processor) or an invisible character would be read differently "
        "from what people see. Comments and texts in quotes may have any character but those that end a "
        "line in some editors only, change the direction of writing, or control a terminal.",
        "P0010 MOVEJ \u221230 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ -30 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0119",
        "index-too-long",
        "error",
        "an index has too many digits",
        "An index is a number of at most nine digits. A longer one is most likely a number that has lost "
        "the blank before it.",
        "P0010000000 STOP",
        "P0010 STOP",
    ),
)
