"""The words that open a declaration or a block; they can't be declared."""

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
