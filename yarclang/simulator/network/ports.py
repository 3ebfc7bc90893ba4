"""Ports, which send lines to the machine."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Port:
    """State of a port.

    Attributes:
        motor: the motor that it addresses (#).
        system: the coordinate system that it addresses (&).
        open: kind of the buffer that it has open: `rotary`, `prog`, `plc`, or empty for none.
        number: number of the open PROG or PLC.
    """

    motor: int = 1
    system: int = 1
    open: str = ""
    number: int = 0
