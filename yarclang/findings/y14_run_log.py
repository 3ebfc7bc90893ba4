"""Findings of family 14: logs of runs."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1401",
        "no-run-log",
        "error",
        "the file isn't the log of a run",
        "yarc run writes a log for each run: an MCAP file with the program, its controller text and all "
        "that was reported. Other files, MCAP files of other tools, and logs that are cut off before the "
        "program can't be shown.",
    ),
    Finding(
        "Y1402",
        "run-log-cut-off",
        "warning",
        "the log of the run is unfinished or damaged",
        "The log was still being written, the process that wrote it was killed, the disk was full, or the "
        "file was copied only in part. Everything up to the damage is shown; the end of the run isn't "
        "known.",
    ),
    Finding(
        "Y1403",
        "run-log-version",
        "error",
        "the log was written by another version",
        "The content of logs may change between versions, so that numbers could be misread. Read the log "
        "with the version that wrote it.",
    ),
    Finding(
        "Y1404",
        "run-log-without-plan",
        "error",
        "the controller text in the log can't be read",
        "The planned motion is rebuilt from the text that was streamed. The text is read by the judge's "
        "strict reader, which also reads texts that are proved. A text that the reader refuses was written "
        "by another version, or was damaged.",
    ),
    Finding(
        "Y1405",
        "run-log-without-positions",
        "error",
        "the log has no positions of the robot to show",
        "The run ended before the controller had reported a position: it was refused, or never connected. "
        "`yarc replay` shows the messages of the run.",
    ),
    Finding(
        "Y1406",
        "run-of-another-robot",
        "error",
        "the log is of another robot than the given one",
        "A log contains the joint positions of a run, but not the robot's shape, which is read from the "
        "robot's own files. The files of another robot would show a wrong motion.",
    ),
)
