"""Findings of family 13: robot.toml, its form, its names and frames."""

from __future__ import annotations

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1301",
        "unknown-robot",
        "error",
        "there is no robot of this name",
        "A robot's name is looked up in the standard library. Name your own robot by the path of its "
        "robot.toml, or of the folder with this file.",
        "ROBOT INDUSTRAIL6",
        "ROBOT INDUSTRIAL6",
    ),
    Finding(
        "Y1302",
        "unreadable-file",
        "error",
        "the file can't be read",
        "robot.toml, cell.toml and URDF must be there, be readable, and be UTF-8 text. The URDF's path is "
        "relative to the folder of the robot.toml.",
        'urdf = "industrial.urdf"',
        'urdf = "industrial6.urdf"',
    ),
    Finding(
        "Y1303",
        "not-toml",
        "error",
        "the file isn't TOML",
        "The text breaks a rule of TOML, so that no part of the file can be used.",
        "velocity = 60 deg",
        "velocity = 60",
    ),
    Finding(
        "Y1304",
        "missing-key",
        "error",
        "a key is missing",
        "A key without a safe default must be given: a guessed speed or gear ratio would move the arm "
        "wrongly.",
        "[joints.J1]\nposition = [-170, 170]",
        "[joints.J1]\nposition = [-170, 170]\nvelocity = 60\nacceleration = 240\njerk = 2000",
    ),
    Finding(
        "Y1305",
        "unknown-key",
        "error",
        "the table has no such key",
        "A misspelled key would be ignored, and its default used instead.",
        "stop_aceleration = 500",
        "stop_acceleration = 500",
    ),
    Finding(
        "Y1306",
        "wrong-type",
        "error",
        "the value is of another type",
        "Values aren't converted: a text isn't a number, even \"60\", and 1.0 isn't an integer, as the "
        "number of a motor must be.",
        'velocity = "60"',
        "velocity = 60",
    ),
    Finding(
        "Y1307",
        "not-finite",
        "error",
        "the number isn't finite",
        "nan and inf spread through every sum; numbers beyond 1e12 lose digits.",
        "velocity = inf",
        "velocity = 60",
    ),
    Finding(
        "Y1308",
        "out-of-range",
        "error",
        "the value is out of its range",
        "Speeds, accelerations and jerks must be above 0; settings of the controller must be values that it "
        "accepts.",
        "velocity = -60",
        "velocity = 60",
    ),
    Finding(
        "Y1309",
        "wrong-length",
        "error",
        "the list has another number of entries",
        "Lists have one entry for each joint, in the order of the chain. A pair of limits has two entries, "
        "a position in space has three.",
        "HOME = [0, 0, 0, 0, 0]",
        "HOME = [0, 0, 0, 0, 0, 0]",
    ),
    Finding(
        "Y1310",
        "bad-name",
        "error",
        "the name can't be used in a program",
        "Names consist of ASCII letters, digits and _. A name can't be P followed by digits, which is a "
        "command's index, nor B or FLANGE, which are the frames at the ends of the chain.",
        "[frames.FLANGE]",
        "[frames.TCP]",
    ),
    Finding(
        "Y1311",
        "name-twice",
        "error",
        "the name is declared twice",
        "Programs read names without regard to case, so tcp and TCP would be one frame with two places.",
        "[frames.TCP]\n[frames.tcp]",
        "[frames.TCP]\n[frames.TCP2]",
    ),
    Finding(
        "Y1328",
        "segment-time",
        "error",
        "the longest segment time is out of range",
        "A segment shorter than three real-time interrupts can't be calculated in time. A segment time TM "
        "above 4,096 ms is clipped (TSRM 476).",
        "largest_tm = 2",
        "largest_tm = 50",
    ),
    Finding(
        "Y1329",
        "unknown-parent",
        "error",
        "the parent of a frame isn't a frame",
        "A frame of robot.toml is attached to FLANGE, or to another frame of the file.",
        'parent = "FLANG"',
        'parent = "FLANGE"',
    ),
    Finding(
        "Y1330",
        "frame-circle",
        "error",
        "frames are attached to each other in a circle",
        "The chain of parents of each frame must end at FLANGE; otherwise the frame's place on the robot "
        "isn't known.",
        '[frames.A1]\nparent = "A2"\n[frames.A2]\nparent = "A1"',
        '[frames.A1]\nparent = "FLANGE"\n[frames.A2]\nparent = "A1"',
    ),
)
