"""Findings of family 20: faults of yarclang itself, not of the program."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y2001",
        "internal-error",
        "error",
        "yarclang itself has failed",
        "This is an error of yarclang, not of the program. No output is written for this program; other "
        "files are still checked. Please report the error, with the lines that the help shows.",
    ),
    Finding(
        "Y2002",
        "unproved-form",
        "error",
        "the formatted program may not mean the same",
        "Before a formatted program is written, it is read again. It must have the same words and numbers, "
        "and the same comments in the same places. Formatting it again must not change it. Here one of "
        "these failed, so the formatter has an error, and the file stays unchanged. Please report it.",
    ),
    Finding(
        "Y2003",
        "out-of-memory",
        "error",
        "there was not enough memory",
        "The operating system gave no more memory while a program was checked. No output is written for "
        "this program; other files are still checked.",
    ),
    Finding(
        "Y2004",
        "killed-process",
        "error",
        "the processes that handled a file were ended",
        "When several files are checked or compiled, several processes share them. If a process is ended "
        "from outside, its file is tried once more. If that process is ended as well, the file gets this "
        "finding, and all other files are still handled. The usual cause is too little memory: use fewer "
        "processes with --jobs.",
    ),
)
