"""Findings of family 20: faults of yarclang itself, not of the program."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y2001",
        "internal-error",
        "error",
        "yarclang itself has failed",
        "yarclang has an error of its own; the program isn't the cause. No output is written for this "
        "program; other files are still checked. Please report the error: the help has the lines to "
        "copy.",
    ),
    Finding(
        "Y2002",
        "unproved-form",
        "error",
        "the formatted program can't be proved to mean the same",
        "Before a formatted program is written, it is read again: it must have the same words and numbers, "
        "the same comments in the same places, and must not change if formatted again. Otherwise the "
        "formatter has an error, and the file stays unchanged. Please report it.",
    ),
    Finding(
        "Y2003",
        "out-of-memory",
        "error",
        "there was not enough memory",
        "The operating system gave no more memory while a program was checked. Nothing is written for this "
        "program; other files are still checked.",
    ),
    Finding(
        "Y2004",
        "killed-process",
        "error",
        "the processes that worked on a file were ended",
        "Files that are checked or compiled together are shared among processes. A process that is ended "
        "costs only the file that it had, and that is tried once more. If the second process ends as well, "
        "the file has this finding, and the other files are worked on all the same. The usual reason is "
        "too little memory: give fewer processes with --jobs.",
    ),
)
