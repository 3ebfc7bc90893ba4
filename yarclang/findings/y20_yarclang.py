"""Family 20: yarclang itself: what is wrong with it, and not with the program."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y2001",
        "internal-error",
        "error",
        "yarclang itself has failed",
        "Something in yarclang went wrong that isn't the program's fault. Nothing is written for this program, and other files are checked all the "
        "same. Please report it: the help has the lines to copy.",
    ),
    Finding(
        "Y2002",
        "unproved-form",
        "error",
        "the usual form of a program can't be proved to say the same",
        "Before a program is written in its usual form, the new text is read again: it must have the same words and numbers, the same comments in the "
        "same places, and must itself be in form. If it hasn't, the formatter is wrong, and the file stays as it is. Please report it.",
    ),
    Finding(
        "Y2003",
        "out-of-memory",
        "error",
        "the memory was not enough",
        "The operating system gave no more memory while a program was checked. Nothing is written for this program, and other files are checked all "
        "the same.",
    ),
    Finding(
        "Y2004",
        "killed-process",
        "error",
        "the processes that worked on a file were ended",
        "Files that are checked or compiled together are shared among processes. A process that is ended costs only the file that it had, and that is tried "
        "once more. If the second process ends as well, the file has this finding, and the other files are worked on all the same. The usual reason is too "
        "little memory: give fewer processes with --jobs.",
    ),
)
