"""A simulated Turbo PMAC, as the machines around its robot see it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from yarclang.robot.model import Array
from yarclang.simulator.machine import Companion, Machine

_PORT = 9
"""A port of the machine that no client has."""

_SYSTEM = 1


class Beside:
    """What the machines around a robot may do with a simulated controller (`yarclang.simulated_cell.playing.SimulatedController`).

    Args:
        machine: the controller.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine = machine

    @property
    def now(self) -> float:
        """Its time [s]."""
        return self._machine.now

    def join(self, companion: Companion) -> None:
        """Let something go on beside it."""
        self._machine.companions.append(companion)

    def define(self, variable: str) -> None:
        """Let an M-variable that points nowhere be a variable of its own."""
        if variable[0] == "M" and int(variable[1:]) not in self._machine.variables.m:
            self._machine.command(f"{variable}->*", _PORT)

    def read(self, variable: str) -> float:
        """Return the value of a variable: plain memory, which may be read in any thread."""
        return self._machine.variables.read(variable[0], int(variable[1:]), _SYSTEM)

    def write(self, variable: str, value: float) -> None:
        """Give a variable a value."""
        self._machine.variables.write(variable[0], int(variable[1:]), value, _SYSTEM)

    def watch(self, variable: str, heard: Callable[[float], None]) -> None:
        """Let a function hear each value that a variable gets."""
        self._machine.variables.watch(variable[0], int(variable[1:]), heard)

    def positions(self, motors: Sequence[int]) -> Array:
        """Return where motors are (n,) [counts]."""
        return self._machine.positions(motors=tuple(motors))
