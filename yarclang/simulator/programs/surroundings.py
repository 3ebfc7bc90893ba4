"""The machine as programs see it: other programs, ports, the interpreter, PLCs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from yarclang.simulator.programs.program import Program


class Surroundings(Protocol):
    """The machine as motion programs and PLCs see it."""

    programs: dict[int, Program]

    @property
    def interrupt(self) -> float:
        """Time between real-time interrupts [s]."""
        ...

    def say(self, text: str) -> None:
        """Execute SEND."""
        ...

    def queue(self, text: str, system: int, motor: int = 1) -> None:
        """Execute CMD: queue a line for the background interpreter.

        The line addresses the given coordinate system and motor.
        """
        ...

    def switch_plcs(self, name: str, numbers: Sequence[int]) -> None:
        """Execute ENABLE, DISABLE, PAUSE or RESUME for PLCs."""
        ...

    def unknown(self, word: str) -> None:
        """Report a word that is skipped."""
        ...
