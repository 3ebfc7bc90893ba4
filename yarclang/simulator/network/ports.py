"""Ports of the controller: each client sends its lines to one of them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Port:
    """State of a port of the controller, from which lines come.

    Attributes:
        motor: number of the motor that the port addresses (#).
        system: number of the coordinate system that the port addresses (&).
        open: kind of the buffer that the port has open: `rotary`, `prog`, `plc`, or empty for none.
        number: number of the open PROG or PLC.
    """

    motor: int = 1
    system: int = 1
    open: str = ""
    number: int = 0
