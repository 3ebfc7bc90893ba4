"""The words of the language that no command's file knows."""

DECLARATIONS = frozenset(
    [
        "ROBOT",
        "CELL",
        "USE",
        "DEFAULT",
        "FRAME",
        "FRAME_QUAT",
        "JOINTS",
        "START",
        "INPUT",
        "OUTPUT",
        "LET",
        "SUB",
        "END",
        "REPEAT",
        "IF",
        "ELSE",
        "WHEN",
    ]
)

OTHER_COMMANDS = frozenset(["MOVEC", "MOVEL_SPLINE", "WAIT", "SET", "HOLD", "CALL"])
"""Commands of the language that no file of commands/builtin carries out."""

OTHER_SUFFIXES = frozenset(["AVOID", "SCURVE", "TOPP"])
"""Suffixes of the language that no file of motion/profiles carries out."""
