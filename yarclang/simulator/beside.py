"""A simulated Turbo PMAC as seen by the machines around its robot."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from yarclang.robot.model import Array
from yarclang.simulator.machine import Companion, Machine

_PORT = 9
"""Number of the controller's port that is reserved for this access; no client uses it."""

_SYSTEM = 1


class Beside:
    """Access to the registers of a simulated controller for the machines around its robot.

    It implements `yarclang.simulated_cell.playing.SimulatedController`.

    Args:
        machine: the simulated controller.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine = machine

    @property
    def now(self) -> float:
        """Virtual time of the controller [s]."""
        return self._machine.now

    def join(self, companion: Companion) -> None:
        """Add a companion that runs in the controller's virtual time."""
        self._machine.companions.append(companion)

    def define(self, variable: str) -> None:
        """Make an M-variable without an address a variable with a value of its own."""
        if variable[0] == "M" and int(variable[1:]) not in self._machine.variables.m:
            self._machine.command(f"{variable}->*", _PORT)

    def read(self, variable: str) -> float:
        """Return the value of a variable. Any thread may call this, since variables are plain memory."""
        return self._machine.variables.read(variable[0], int(variable[1:]), _SYSTEM)

    def write(self, variable: str, value: float) -> None:
        """Assign a value to a variable."""
        self._machine.variables.write(variable[0], int(variable[1:]), value, _SYSTEM)

    def watch(self, variable: str, callback: Callable[[float], None]) -> None:
        """Call a function with each value that is assigned to a variable."""
        self._machine.variables.watch(variable[0], int(variable[1:]), callback)

    def positions(self, motors: Sequence[int]) -> Array:
        """Return the commanded positions of motors (n,) [counts]."""
        return self._machine.positions(motors=tuple(motors))
