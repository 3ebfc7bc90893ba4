"""Content that only a text for a Turbo PMAC has."""

from __future__ import annotations

from yarclang.certify.read.text import ControllerText, Sent
from yarclang.frozen import frozen
from yarclang.robot.model import Array

TM_STEPS_PER_MS = 4096
"""Steps of TM in 1 ms: a fixed-point number with 12 integer and 12 fraction bits (TSRM 476, I42 = 0)."""


@frozen
class Marks:
    """The definition of the rotary buffer in a text.

    Attributes:
        low: number of lines below which the buffer counts as low (I16).
        full: number of lines from which on the buffer counts as full (I17).
        words: length of the buffer in words.
    """

    low: int
    full: int
    words: int


@frozen
class Armed:
    """A line of the text that sets (`on`) or clears the guard's flag P8100."""

    line: int
    on: bool


@frozen(eq=False)
class Guard:
    """The guard of a program buffer, which lets the program begin only at its start position.

    The program waits until each motor is near this position. Positions are in 1/(32 Ixx08) count, with the
    motor's I-variable Ixx08: this is the unit of the register of the commanded position.

    Attributes:
        place: (n,) motor positions at the start.
        width: (n,) largest distances from `place`.
        step: (n,) value of the last printed digit of `place`.
    """

    place: Array
    width: Array
    step: Array


@frozen(eq=False)
class PmacText:
    """The content of a controller text that only texts for a Turbo PMAC have.

    Attributes:
        marks: definition of the rotary buffer; None for a program buffer.
        guard: the guard that lets a program buffer begin only at its start; None for a rotary buffer, whose
            start is reached by a RAPID.
        arms: the lines that arm and disarm the guard of the rotary buffer, in order.
        setup: the lines before `OPEN ROT`; empty for a program buffer.
        loaded: the lines stored in the rotary buffer, between `CLEAR` and `CLOSE`; empty for a program
            buffer.
    """

    marks: Marks | None
    guard: Guard | None
    arms: tuple[Armed, ...]
    setup: tuple[str, ...]
    loaded: tuple[Sent, ...]


def own_of(content: ControllerText) -> PmacText:
    """Return the content that only a text for a Turbo PMAC has."""
    assert isinstance(content.own, PmacText)
    return content.own
