"""What on-line commands reach: all that a line may ask of the controller, or order."""

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
        """R or S in a coordinate system.

        Raises:
            Refusal: the program can't run.
        """
        ...

    def switch_plcs(self, name: str, numbers: Sequence[int]) -> None:
        """ENABLE, DISABLE, PAUSE, RESUME."""
        ...

    def changed(self, motors: Sequence[Motor]) -> None:
        """Motors move otherwise from now on."""
        ...

    def save(self) -> None:
        """SAVE."""
        ...

    def reset(self) -> None:
        """$$$."""
        ...

    def initialise(self) -> None:
        """$$$***."""
        ...
