"""The words of the language: those of commands and declarations, which are defined in files
(`yarclang/words`), and those of options and expressions.
"""

from types import MappingProxyType

from yarclang.syntax.ast import Statement
from yarclang.words.registry import word_specs

LONGEST_INDEX = 9
"""Largest number of digits of an index."""

BLOCK_HEADS = frozenset(name for name, word in word_specs().items() if word.opens_block)
"""Words that begin a block. The block ends at its END, or at the UNTIL of a LOOP."""

BLOCK_ENDS = frozenset(name for name, word in word_specs().items() if word.ends_block)
"""Words that end a block."""


def opens_block(statement: Statement) -> bool:
    """Return True if a statement begins a block, which ends at one of `BLOCK_ENDS`."""
    return statement.name.name in BLOCK_HEADS or statement.waits_else


DECLARATIONS = frozenset(name for name, word in word_specs().items() if not word.is_command)
"""Words that begin a line without an index."""

DECLARATIONS_IN_BLOCKS = frozenset(name for name, word in word_specs().items() if word.in_blocks)
"""Declarations that are allowed in a block, besides commands and blocks."""

AVOID = "AVOID"
"""Part of a motion's name, between target and profile. A motion with this part goes around obstacles."""

OPTIONS = frozenset(["BLEND", "ACC", "TOL", "NEAR", "STRETCH", "UNTIL", "INTO", "ALLOW"])
"""Words that begin an option."""

RATES = frozenset(["VEL", "ACC"])
"""Words that begin the velocities and accelerations at a waypoint. They occur only after a time, where no
name is allowed.
"""

OPERATORS = frozenset(["OR", "AND", "NOT"])
"""Operators that are words."""

FUNCTIONS = MappingProxyType(
    {
        "SQRT": (1, 1),
        "SIN": (1, 1),
        "COS": (1, 1),
        "TAN": (1, 1),
        "ATAN2": (2, 2),
        "ABS": (1, 1),
        "MIN": (2, None),
        "MAX": (2, None),
        "FLOOR": (1, 1),
        "CEIL": (1, 1),
    }
)
"""The functions of expressions, with the smallest and largest number of arguments (None: any number)."""

CONSTANTS = frozenset(["PI"])
"""Names of numbers that every expression may use. They can't be declared."""

STATES = frozenset(["ON", "OFF"])
"""States of an input or an output."""

RESERVED = word_specs().keys() | OPTIONS | OPERATORS | FUNCTIONS.keys() | CONSTANTS | STATES
"""Words that can't be declared as names.

Units are not among them, since they occur only in round brackets, where no name is allowed. The V of
`[V 250]` is not among them either, since a name has a `$` before it there.
"""
