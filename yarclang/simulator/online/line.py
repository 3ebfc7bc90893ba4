"""A line while it is executed, and the limits that apply to all lines."""

from __future__ import annotations

import re

from yarclang.simulator.language.reader import Reader
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.system import CoordinateSystem
from yarclang.simulator.network.ports import Port
from yarclang.simulator.online.surroundings import Controller
from yarclang.simulator.state.registers import Seen

LONGEST = 255
"""Largest number of characters of a line (facts 3)."""

LEGAL = re.compile(r"[\t\r\n -~]*").fullmatch
"""Matches a text if all of its characters are allowed in a line."""


class Line:
    """A line from a port while the controller executes it.

    Attributes:
        machine: the controller.
        port: the port from which the line comes, with the motor and the coordinate system that it addresses.
        reader: the line and the position in it.
        items: the answers so far.
    """

    __slots__ = ("items", "machine", "port", "reader")

    def __init__(self, machine: Controller, port: Port, text: str) -> None:
        self.machine = machine
        self.port = port
        self.reader = Reader(text)
        self.items: list[str] = []

    @property
    def motor(self) -> Motor:
        """The addressed motor."""
        return self.machine.motors[self.port.motor]

    @property
    def system(self) -> CoordinateSystem:
        """The addressed coordinate system."""
        return self.machine.systems[self.port.system]

    @property
    def scope(self) -> Seen:
        """The variables as the addressed coordinate system sees them."""
        return self.machine.variables.scope(self.port.system)
