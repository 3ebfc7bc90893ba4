"""What a simulated controller lets the machines around its robot do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from yarclang.robot.model import Array


class Companion(Protocol):
    """What goes on beside a simulated controller."""

    @property
    def next_event(self) -> float:
        """When it has something to do next [s of the controller]; -inf for now."""

    def handle(self) -> None:
        """Do what is due by the controller's time."""


class SimulatedController(Protocol):
    """A simulated controller, as the machines around it see it. `read` may be called in any thread."""

    @property
    def now(self) -> float:
        """Its time [s]."""

    def join(self, companion: Companion) -> None:
        """Let something go on beside it."""

    def define(self, variable: str) -> None:
        """Let the variable of an input or output that points nowhere be one of its own."""

    def read(self, variable: str) -> float:
        """Return the value of a variable."""

    def write(self, variable: str, value: float) -> None:
        """Give a variable a value."""

    def watch(self, variable: str, heard: Callable[[float], None]) -> None:
        """Let a function hear each value that a variable gets."""

    def positions(self, motors: Sequence[int]) -> Array:
        """Return where motors are (n,) [counts]."""
