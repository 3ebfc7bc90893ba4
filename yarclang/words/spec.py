"""Specifications of words that begin a line and are neither motions nor actions: a `WordSpec` for each.

Each specification is in a file of words/builtin. The parser's tables, the checks of where the word is
allowed, completion, hover, snippets and the highlighter use it. The word's effect is implemented in
`semantics/`, since such a word declares names or decides which lines are carried out.
"""

from __future__ import annotations

from enum import Enum
from typing import Literal

from yarclang.frozen import frozen


class Slot(Enum):
    """The kind of a value after a word of the language."""

    INPUT = "input"
    OUTPUT = "output"
    STATE = "state"
    """State of a signal: ON, OFF or a number."""
    TEXT = "text"
    """Text in quotes."""
    REGISTER = "register"
    REACTION = "reaction"
    """Reaction to a watched input: HOLD, or CALL followed by the name of a SUB."""
    TAUGHT = "taught"
    """Name of a place that is taught at run time."""
    TOOL = "tool"
    """A tool of the cell that can be changed, or NONE."""

    @property
    def is_signal(self) -> bool:
        """True for the name of an input or output."""
        return self is Slot.INPUT or self is Slot.OUTPUT


@frozen
class WordSpec:
    """The specification of one word of the language that begins a line and is neither a motion nor an action.

    Attributes:
        name: the word.
        summary: one line about the word.
        example: a line with the word, without an index.
        is_command: True if the word may have an index like a command.
        opens_block: True if the word begins a block, up to END.
        takes_else: True if the block may have an ELSE.
        ends_block: True if the word ends the block of another word.
        in_blocks: True if the word is allowed in a block, although it is a declaration.
        at_the_top: True if the word must come before the first command.
        once: True if a file has at most one such line.
        of_programs: True if the word isn't allowed in a module.
        declares: kind of the name after the word; empty without one. A finding reports names that are never
            used.
        proposes: kind of names that completion proposes after the word.
        slots: kinds of the word's values, if each line has the same number of them.
        first: words that may be the first value, each with one line about it.
        wants: description of the values, for a finding about wrong ones.
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
    first: tuple[tuple[str, str], ...] = ()
    wants: str = ""
