"""Words of other robot languages that may stand at the start of a line, and help texts that name the
replacement.
"""

from types import MappingProxyType

_WAYS = (
    "CASE N ... OF 1 ... END and WHEN DOOR ON ... ELSE ... END choose a way when the program runs, IF by "
    "numbers when it is compiled"
)
_LOOPS = (
    "REPEAT I 4 ... END repeats lines; LOOP ... UNTIL DOOR ON, WHILE N < 3 ... END and LOOP ... EXIT ... "
    "END go on as long as the program decides when run"
)
_JUMPS = (
    "no line is jumped to: lines that are used in several places stand in a SUB, which CALL carries out; "
    "WHEN and REPEAT lead the way"
)

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
