"""Family 14: logs of runs."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1401",
        "no-run-log",
        "error",
        "the file isn't the log of a run",
        "yarc run writes a log for each run, an MCAP file with the program, its text for the controller and all that was "
        "reported. Other files, other tools' MCAP files, and logs that are cut off before the program can't be shown.",
    ),
    Finding(
        "Y1402",
        "run-log-cut-off",
        "warning",
        "the log of the run is unfinished or damaged",
        "The log was still being written, its process was killed, the disk was full, or the file was copied in part. "
        "What stands before that place is shown; how the run ended isn't known from here.",
    ),
    Finding(
        "Y1403",
        "run-log-version",
        "error",
        "the log was written by another version",
        "What stands in a log may change between versions, and a number that is taken for another is worse than none. The version "
        "that wrote the log can always read it.",
    ),
    Finding(
        "Y1404",
        "run-log-without-plan",
        "error",
        "the controller text in the log can't be read",
        "The planned motion is rebuilt from the text that was streamed, by the same strict reader that certifies it. A text that it "
        "refuses was written by another version, or was damaged.",
    ),
)
