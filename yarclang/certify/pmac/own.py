"""What only a text for a Turbo PMAC says."""

from __future__ import annotations

from yarclang.certify.read.text import ControllerText, Sent
from yarclang.frozen import frozen
from yarclang.robot.model import Array

TM_STEPS_PER_MS = 4096
"""TM is a fixed-point number of 12 integer and 12 fraction bits (TSRM 476, I42 = 0)."""


@frozen
class Marks:
    """The rotary buffer as the text defines it: `words` long; it counts as low below `low` lines (I16), as full from `full` on (I17)."""

    low: int
    full: int
    words: int


@frozen
class Armed:
    """The guard's flag P8100 is set (`on`) or cleared in a line of the text."""

    line: int
    on: bool


@frozen(eq=False)
class Guard:
    """A fixed program begins nowhere but at its start: it waits until each motor is within `width` of `place` (n,), both in 1/(Ixx08 * 32) count as the register of
    the commanded position is; `step` (n,) is the last printed digit of `place`.
    """

    place: Array
    width: Array
    step: Array


@frozen(eq=False)
class PmacText:
    """What only a text for a Turbo PMAC says.

    Attributes:
        marks: the rotary buffer; None for a program buffer.
        guard: how a program buffer begins at its start; None for a rotary, which a RAPID leads there.
        arms: where the guard is armed and disarmed, in order.
        setup: the lines in front of `OPEN ROT`; empty for a program buffer.
        loaded: the lines that are stored in the rotary, between `CLEAR` and `CLOSE`; empty for a program buffer.
    """

    marks: Marks | None
    guard: Guard | None
    arms: tuple[Armed, ...]
    setup: tuple[str, ...]
    loaded: tuple[Sent, ...]


def own_of(content: ControllerText) -> PmacText:
    """Return what only a text for a Turbo PMAC says."""
    assert isinstance(content.own, PmacText)
    return content.own
