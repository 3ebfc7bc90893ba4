"""Findings of family 13, sixth part: the files of timed trajectories beside programs."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1380",
        "trajectory-columns",
        "error",
        "the columns of a trajectory file aren't those of the robot",
        "The first line names the columns: time, and all joints of the robot. Columns for velocities may be "
        "added, for all joints or for none, and then columns for accelerations in the same way. Columns are "
        "identified by their names, so if a joint is missing or repeated, the motion isn't defined.",
        "time,J1,J2,J3,J4,J5,J5",
        "time,J1,J2,J3,J4,J5,J6",
    ),
    Finding(
        "Y1381",
        "trajectory-units",
        "error",
        "the units of a trajectory file aren't clear",
        "The header must give units for all columns of a kind or for none. Without units in the header, "
        "those of the program's line or of its DEFAULT are used. A mixture of deg and rad would turn a "
        "joint 57 times too far.",
        "time [s],J1 [deg],J2 [rad]",
        "time [s],J1 [deg],J2 [deg]",
    ),
    Finding(
        "Y1382",
        "trajectory-cells",
        "error",
        "a cell of a trajectory file is missing or isn't a number",
        "Every row has a cell for each column, and every cell is a finite decimal number. A gap, NaN or a "
        "decimal comma in the place of a joint value would move the arm to a wrong place.",
        "0.5,10,0,nan,0,20,0",
        "0.5,10,0,0,0,20,0",
    ),
    Finding(
        "Y1383",
        "trajectory-times",
        "error",
        "the times of a trajectory file don't increase, or the robot isn't at rest at its beginning and end",
        "Each row must be later than the one before. The velocities at time 0 and in the last row must be 0.",
        "0.5,10,0,0,0,20,0\n0.5,12,0,0,0,20,0",
        "0.5,10,0,0,0,20,0\n0.6,12,0,0,0,20,0",
    ),
    Finding(
        "Y1384",
        "trajectory-empty",
        "error",
        "a trajectory file has no waypoint",
        "A trajectory needs a header and at least one row after time 0. Without such a row, there is no "
        "motion.",
        "time,J1,J2,J3,J4,J5,J6",
        "time,J1,J2,J3,J4,J5,J6\n0.5,10,0,0,0,20,0",
    ),
    Finding(
        "Y1385",
        "trajectory-place",
        "error",
        "a trajectory file isn't beside its program",
        "A trajectory is a part of its program. Its file must end in .csv, and be in the folder of the "
        "program or module that names it, or in a folder below. Then both files are copied, saved and "
        "reviewed together.",
        'P0010 MOVEJ_TIMED "../elsewhere/path.csv"',
        'P0010 MOVEJ_TIMED "path.csv"',
    ),
)
