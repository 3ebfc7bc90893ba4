"""What a word is that begins a line and is neither a motion nor an action: a value of `WordSpec`, in one file of words/builtin.

The parser's tables, the checks of where it may stand, completion, hover, snippets and the highlighter read it. What it does is known to `semantics/` alone, since such a word
decides what names mean, or which lines are carried out.
"""

from __future__ import annotations

from enum import Enum
from typing import Literal

from yarclang.frozen import frozen


class Slot(Enum):
    """What a value behind a word is."""

    INPUT = "input"
    OUTPUT = "output"
    STATE = "state"
    """ON, OFF or a number."""
    TEXT = "text"
    """A text in quotes."""
    REGISTER = "register"
    REACTION = "reaction"
    """HOLD."""

    @property
    def is_signal(self) -> bool:
        """True for the name of an input or output."""
        return self is Slot.INPUT or self is Slot.OUTPUT


@frozen
class WordSpec:
    """One word of the language.

    Attributes:
        name: the word.
        summary: one line.
        example: a line as it is written, without an index.
        is_command: True if it may have an index, as commands have.
        opens_block: True if END ends what it begins, and `takes_else` if an ELSE may stand in between.
        ends_block: True if it ends what another word begins.
        in_blocks: True if it may stand in a block, though it is a declaration.
        at_the_top: True if it stands before the first command.
        once: True if a file has one at most.
        of_programs: True if a module has none.
        declares: what the name is that follows; a name that is never used is reported.
        proposes: the names that are proposed behind it.
        slots: its values, each of one kind, if there are as many in each line; `wants` says so in words.
    """

    name: str
    summary: str
    example: str
    is_command: bool = False
    opens_block: bool = False
    takes_else: bool = False
    ends_block: bool = False
    in_blocks: bool = False
    at_the_top: bool = False
    once: bool = False
    of_programs: bool = False
    declares: Literal["", "name", "frame"] = ""
    proposes: Literal["", "robots", "modules", "joints", "frames", "arguments", "values"] = ""
    slots: tuple[Slot, ...] = ()
    wants: str = ""
