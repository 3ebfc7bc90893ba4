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
        "Frames are written in { }, the motion time in [ ], units in ( ) and texts in quotes. Each must be "
        "closed in the same line.",
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
        "A program without a command moves nothing: most likely the file was cut off, or a wrong file was "
        "given.",
        "! nothing but a comment",
        "P0010 STOP",
    ),
    Finding(
        "Y0105",
        "missing-index",
        "error",
        "a command has no index",
        "Messages and logs name a command by its index, and `yarc run --from` begins at an index. Only the "
        "live interpreter accepts commands without an index.",
        "STOP",
        "P0010 STOP",
        follows=(Follows("Y0202", "here"),),
    ),
    Finding(
        "Y0106",
        "line-too-long",
        "error",
        "a line or the file is too long for a program",
        "A line may have at most 100,000 characters, and a program 20,000,000. Most likely a data file was "
        "given instead.",
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
        "A .pmc file is the text that yarcc makes of a program. Give the .yarc file that it was made from.",
    ),
    Finding(
        "Y0109",
        "unknown-function",
        "error",
        "no function has this name",
        "Expressions may use the functions SQRT SIN COS TAN ATAN2 ABS MIN MAX FLOOR CEIL, and functions "
        "that a FUNC line above declares. Only functions and numbers can be followed by a bracket; the "
        "bracket after a number contains its unit. A product is written with `*`.",
        "P0010 MOVEJ $(SQR(900)) 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ $(SQRT(900)) 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0110",
        "function-arguments",
        "error",
        "the function takes a different number of arguments",
        "ATAN2 takes two arguments, y and then x. MIN and MAX take two or more. A function that FUNC "
        "declares takes one argument for each of its parameters. All other functions take one. Commas "
        "separate arguments, so a decimal comma turns one number into two.",
        "P0010 MOVEJ $(ABS(0,5)) 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ $(ABS(0.5)) 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0111",
        "foreign-operator",
        "error",
        "an operator of another language",
        "The operators are OR, AND, NOT, = <> < <= > >=, + -, * / %, **. Operators of other languages "
        "aren't accepted, because they may mean something else here. For example, `!` starts a comment, so "
        "the rest of the line would be lost.",
        "P0010 MOVEJ $(3^2) 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ $(3**2) 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0112",
        "too-deep",
        "error",
        "blocks, CALLs or brackets are nested too deeply",
        "In one program, blocks may be nested 100 deep. In one expression, operators, functions and "
        "brackets may be nested 100 deep. CALLs may be nested 150 deep, counted together with the blocks "
        "around them. A program that is nested more deeply most likely comes from a faulty generator.",
    ),
    Finding(
        "Y0113",
        "missing-end",
        "error",
        "a block has no END",
        "SUB, REPEAT, IF, WHEN, CASE, WHILE, a WAIT with an ELSE and a LOOP without UNTIL each need their "
        "own END. Without the END, it isn't clear which commands are repeated or depend on the condition.",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)\nEND",
        needs="end",
    ),
    Finding(
        "Y0114",
        "end-without-block",
        "error",
        "an END or ELSE is not in a block",
        "END ends the innermost open block, and ELSE divides this block. If no block is open, its first "
        "line is missing, and the commands that belong in the block would always run.",
        "P0010 MOVEJ HOME [5] (s)\nEND",
        "P0010 MOVEJ HOME [5] (s)",
        needs="block",
    ),
    Finding(
        "Y0115",
        "misplaced-else",
        "error",
        "the block can't have this ELSE",
        "IF and WHEN may have one ELSE each; SUB and REPEAT have none. To distinguish a third case, write "
        "another IF, with its own END, in the lines after ELSE.",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)\nELSE\n  P0020 MOVEJ HOME [5] (s)\nEND",
        "REPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)\nEND\nP0020 MOVEJ HOME [5] (s)",
    ),
    Finding(
        "Y0116",
        "not-in-a-block",
        "error",
        "this line isn't allowed in a block",
        "Blocks may contain commands, FRAME, POSE, JOINTS, LET and blocks other than SUB. Declarations for "
        "the whole file must be outside of blocks, because a loop or a condition would repeat or skip them.",
        "REPEAT 2\n  DEFAULT (deg,s)\n  P0010 DMOVEJ 5 0 0 0 0 0 [1]\nEND",
        "DEFAULT (deg,s)\nREPEAT 2\n  P0010 DMOVEJ 5 0 0 0 0 0 [1]\nEND",
    ),
    Finding(
        "Y0117",
        "surplus-index",
        "error",
        "a declaration has an index",
        "Only commands have an index. Messages and logs name a command by its index, and `yarc run --from` "
        "begins at an index. A declaration isn't executed, so it needs no index.",
        "P0010 LET A = 30\nP0020 MOVEJ $A 0 0 0 0 0 [5] (deg,s)",
        "LET A = 30\nP0010 MOVEJ $A 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0118",
        "foreign-character",
        "error",
        "a character that isn't allowed in a program",
        "Outside of comments and quoted texts, a program may contain only blanks, tabs and the printable "
        "characters of ASCII. A look-alike (a no-break space, a minus sign from a text processor) or an "
        "invisible character would be read differently from how it looks. Comments and quoted texts may "
        "contain any character, with three exceptions: characters that only some editors treat as a line "
        "end, characters that change the direction of writing, and characters that control a terminal.",
        "P0010 MOVEJ \u221230 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ -30 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0119",
        "index-too-long",
        "error",
        "an index has too many digits",
        "An index is a number of at most nine digits. If an index is longer, most likely the blank after it "
        "is missing, so that the next number was read as a part of it.",
        "P0010000000 STOP",
        "P0010 STOP",
    ),
)
