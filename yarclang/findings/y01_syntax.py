"""Family 01: the text itself."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0101",
        "unexpected-text",
        "error",
        "something stands where it can't stand",
        "The seven parts of a command have one order: index, name, {moving frame}, values, [motion time], (units), "
        "{base frame}, then options. A line that can be read in two ways could move the arm in two ways, so nothing is guessed.",
        "P0010 MOVEJ 0 0 0 0 0 0 (deg,s) [5]",
        "P0010 MOVEJ 0 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0102",
        "unclosed",
        "error",
        "a bracket or a text is not closed",
        "Frames stand in { }, the motion time in [ ], units in ( ), texts in quotes; each is closed in its own line.",
        "P0010 MOVEJ 0 0 0 0 0 0 [5 (deg,s)",
        "P0010 MOVEJ 0 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0103",
        "not-text",
        "error",
        "the file is not UTF-8 text",
        "A program is UTF-8 text (a byte order mark and CRLF line ends are fine). A control character or a byte that isn't "
        "UTF-8 means that this is another kind of file, or that it was damaged on its way.",
    ),
    Finding(
        "Y0104",
        "empty-program",
        "error",
        "the file has no command",
        "A program without a command moves nothing: most likely the file was cut off, or another one was meant.",
        "! nothing but a comment",
        "P0010 STOP",
    ),
    Finding(
        "Y0105",
        "missing-index",
        "error",
        "a command has no index",
        "Messages, logs and a later start in the middle speak of a command by its index. Only the live interpreter does without.",
        "STOP",
        "P0010 STOP",
    ),
    Finding(
        "Y0106",
        "line-too-long",
        "error",
        "a line is longer than any program line",
        "Lines of more than 100,000 characters are no program: most likely a data file was given instead.",
    ),
    Finding(
        "Y0107",
        "file-not-accessible",
        "error",
        "the file can't be read or written",
        "The operating system refused the file; its reason stands in the message.",
    ),
    Finding(
        "Y0108",
        "controller-text",
        "error",
        "this is the controller's text, not a program",
        "A .pmc file is what yarcc makes of a program. To read it as a program would give a finding a line.",
    ),
)
