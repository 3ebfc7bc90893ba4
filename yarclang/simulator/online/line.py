"""A line while it is executed, and what holds for all lines."""

from __future__ import annotations

import re

from yarclang.simulator.language.reader import Reader
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.system import CoordinateSystem
from yarclang.simulator.network.ports import Port
from yarclang.simulator.online.surroundings import Controller
from yarclang.simulator.state.registers import Seen

LONGEST = 255
"""Characters of a line (facts 3)."""

LEGAL = re.compile(r"[\t\r\n -~]*").fullmatch
"""Whether a line has no characters but those of the language."""


class Line:
    """A line from a port: what is left of it to be read, and what it has been answered so far.

    Attributes:
        machine: the controller that executes it.
        port: where it comes from, and what that addresses.
        reader: the line, and the place in it.
        items: the answers.
    """

    __slots__ = ("items", "machine", "port", "reader")

    def __init__(self, machine: Controller, port: Port, text: str) -> None:
        self.machine = machine
        self.port = port
        self.reader = Reader(text)
        self.items: list[str] = []

    @property
    def motor(self) -> Motor:
        """The motor that is addressed."""
        return self.machine.motors[self.port.motor]

    @property
    def system(self) -> CoordinateSystem:
        """The coordinate system that is addressed."""
        return self.machine.systems[self.port.system]

    @property
    def scope(self) -> Seen:
        """The variables as that coordinate system sees them."""
        return self.machine.variables.scope(self.port.system)
