"""Words of other robot languages that may stand at the start of a line, and help texts that name the
replacement.
"""

from types import MappingProxyType

_WAYS = (
    "use CASE N ... OF 1 ... END or WHEN DOOR ON ... ELSE ... END to branch when the program runs, IF for "
    "numbers that are known when compiled"
)
_LOOPS = (
    "use REPEAT I 4 ... END for a fixed count; LOOP ... UNTIL DOOR ON, WHILE N < 3 ... END or LOOP ... "
    "EXIT ... END for a condition when run"
)
_JUMPS = "the language has no jumps: put repeated lines in a SUB for CALL, and branch by WHEN and REPEAT"

INSTEAD = MappingProxyType(
    {
        "SWITCH": _WAYS,
        "SELECT": _WAYS,
        "FOR": _LOOPS,
        "GOTO": _JUMPS,
        "JMP": _JUMPS,
        "JUMP": _JUMPS,
        "LBL": _JUMPS,
        "PTP": "MOVEJ goes in joint space, MOVEJ_RPY to a pose",
        "LIN": "MOVEL goes straight",
        "CIRC": "MOVEC goes along an arc",
    }
)
"""Help for each word. A word that becomes part of the language must leave this table."""
