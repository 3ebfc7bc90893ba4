"""The words of the language: sets of those that files describe, and those of options and expressions."""

from types import MappingProxyType

from yarclang.syntax.ast import Statement
from yarclang.words.registry import word_specs

LONGEST_INDEX = 9
"""Digits of an index."""

BLOCK_HEADS = frozenset(name for name, word in word_specs().items() if word.opens_block)
"""Words that begin a block, which END ends."""

BLOCK_ENDS = frozenset(name for name, word in word_specs().items() if word.ends_block)
"""Words that end a block."""


def opens_block(statement: Statement) -> bool:
    """Return True if a statement begins a block, which a word of `BLOCK_ENDS` ends."""
    return statement.name.name in BLOCK_HEADS or statement.waits_else


DECLARATIONS = frozenset(name for name, word in word_specs().items() if not word.is_command)
"""Words that begin a line without an index."""

DECLARATIONS_IN_BLOCKS = frozenset(name for name, word in word_specs().items() if word.in_blocks)
"""Declarations that a block may hold, besides commands and blocks."""

AVOID = "AVOID"
"""The suffix of a name, between target and profile, of a motion that goes round obstacles."""

OPTIONS = frozenset(["BLEND", "ACC", "TOL", "NEAR", "STRETCH", "UNTIL", "INTO"])
"""Words that begin an option."""

RATES = frozenset(["VEL", "ACC"])
"""Words that begin the velocities and accelerations at a way-point. They stand behind a time only, where no name stands."""

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
"""The functions of expressions, with the least and the largest number of arguments (None: any)."""

CONSTANTS = frozenset(["PI"])
"""Names that stand for a number everywhere."""

STATES = frozenset(["ON", "OFF"])
"""What an input or an output is."""

RESERVED = word_specs().keys() | OPTIONS | OPERATORS | FUNCTIONS.keys() | CONSTANTS | STATES
"""Words that can't be declared as names, besides those of the commands. Units are none of them: they stand in
round brackets, where no name stands. Nor is the V of `[V 250]`, since a name has a `$` before it there."""
