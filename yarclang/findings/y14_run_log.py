"""Findings of family 14: logs of runs."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1401",
        "no-run-log",
        "error",
        "the file isn't the log of a run",
        "yarc run writes a log for each run, an MCAP file with the program, its text for the controller "
        "and all that was reported. Other files, other tools' MCAP files, and logs that are cut off before "
        "the program can't be shown.",
    ),
    Finding(
        "Y1402",
        "run-log-cut-off",
        "warning",
        "the log of the run is unfinished or damaged",
        "The log was still being written, its process was killed, the disk was full, or the file was "
        "copied in part. Everything before that place is shown; the end of the run isn't known.",
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
        "The planned motion is rebuilt from the text that was streamed, by the same strict reader that "
        "certifies it. A text that it refuses was written by another version, or was damaged.",
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
        "the log is of another robot than the one that would be shown",
        "A log has the joint positions of a run, but not the robot's shape: that comes from the robot's "
        "own files. Those of another robot would show a wrong motion.",
    ),
)
