"""What programs reach outside of themselves: other programs, ports, the interpreter, PLCs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from yarclang.simulator.programs.program import Program


class Surroundings(Protocol):
    """What motion programs and PLCs need of the machine."""

    programs: dict[int, Program]

    @property
    def interrupt(self) -> float:
        """The time between real-time interrupts [s]."""
        ...

    def say(self, text: str) -> None:
        """SEND."""
        ...

    def queue(self, text: str, system: int, motor: int = 1) -> None:
        """CMD: a line for the interpreter, when it gets to it, and what it addresses."""
        ...

    def switch_plcs(self, name: str, numbers: Sequence[int]) -> None:
        """ENABLE, DISABLE, PAUSE, RESUME."""
        ...

    def unknown(self, word: str) -> None:
        """A word that is skipped."""
        ...
