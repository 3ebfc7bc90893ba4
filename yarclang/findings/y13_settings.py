"""Findings of family 13, second part: the choice of a robot, and the settings of a project."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1391",
        "no-robot",
        "error",
        "no robot is named",
        "Reach, limits and the controller's text depend on the robot: without a robot, nothing can be "
        "checked. Name it on the command line, in a ROBOT line of the program, or in yarc.toml.",
        "P0010 MOVEJ HOME [5] (s)",
        "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME [5] (s)",
    ),
    Finding(
        "Y1392",
        "two-robots",
        "error",
        "the program is for another robot than the command line says",
        "The program names its robot in a ROBOT line, because it was written for that robot's reach and "
        "limits. The command line names another robot.",
        "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME [5] (s)",
    ),
    Finding(
        "Y1393",
        "bad-project-file",
        "error",
        "yarc.toml can't be used as it is",
        "If settings can't be read, they are never skipped silently, because the program would then be "
        "checked with other settings than intended.",
        "robott = 'INDUSTRIAL6'",
        "robot = 'INDUSTRIAL6'",
    ),
    Finding(
        "Y1394",
        "bad-start",
        "error",
        "the start position isn't one of this robot",
        "The first motion depends on the start position. It needs one value for each joint, within the "
        "limits.",
        "yarcc --start 0,0,0",
        "yarcc --start 0,0,0,0,0,0",
    ),
    Finding(
        "Y1395",
        "jobs-apart",
        "error",
        "a job doesn't begin or end where the others begin",
        "The jobs that yarc.toml numbers are called one after the other, in an order that isn't known in "
        "advance. So all jobs must begin and end at the same joint position. Then any job can follow any "
        "other without an unproved motion between them.",
    ),
)
