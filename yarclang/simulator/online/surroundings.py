"""The controller as on-line commands see it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.programs.buffers import Buffers
from yarclang.simulator.programs.plcs import Plcs
from yarclang.simulator.state.wiring import Shown


class Controller(Shown, Protocol):
    """The controller as on-line commands see it."""

    buffers: Buffers
    plcs: Plcs

    def run(self, number: int, single_step: bool = False) -> None:
        """Execute R, or S for a single step, in a coordinate system.

        Raises:
            Refusal: the program can't run.
        """
        ...

    def switch_plcs(self, name: str, numbers: Sequence[int]) -> None:
        """Execute ENABLE, DISABLE, PAUSE or RESUME for PLCs."""
        ...

    def changed(self, motors: Sequence[Motor]) -> None:
        """Record that motors move differently from now on."""
        ...

    def save(self) -> None:
        """Execute SAVE."""
        ...

    def reset(self) -> None:
        """Execute $$$."""
        ...

    def initialise(self) -> None:
        """Execute $$$***."""
        ...
