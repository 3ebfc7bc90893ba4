"""Findings of family 13, second part: the choice of a robot, and the settings of a project."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1391",
        "no-robot",
        "error",
        "no robot is named",
        "Reach, limits and the controller's text are those of a robot: without one, nothing can be "
        "checked. The command line names it, or a ROBOT line of the program, or yarc.toml.",
        "P0010 MOVEJ HOME [5] (s)",
        "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME [5] (s)",
    ),
    Finding(
        "Y1392",
        "two-robots",
        "error",
        "the program is for another robot than the command line says",
        "A program with a ROBOT line was written for that robot's reach and limits.",
        "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME [5] (s)",
    ),
    Finding(
        "Y1393",
        "bad-project-file",
        "error",
        "yarc.toml can't be used as it is",
        "Unreadable settings are never skipped silently: the program would be checked with other settings "
        "than the intended ones.",
        "robott = 'INDUSTRIAL6'",
        "robot = 'INDUSTRIAL6'",
    ),
    Finding(
        "Y1394",
        "bad-start",
        "error",
        "the start position isn't one of this robot",
        "The first motion depends on the start position: one value per joint, within the limits.",
        "yarcc --start 0,0,0",
        "yarcc --start 0,0,0,0,0,0",
    ),
    Finding(
        "Y1395",
        "jobs-apart",
        "error",
        "a job doesn't begin or end where the others begin",
        "The jobs that yarc.toml numbers are called one after the other, in an order that isn't known "
        "before. All begin and end at the same joint position, so that any job may follow any other "
        "without an unproved motion between them.",
    ),
)
