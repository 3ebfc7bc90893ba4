"""A port: who sends lines."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Port:
    """What a port addresses, and the buffer that it has opened: `rotary`, `prog`, `plc` or none."""

    motor: int = 1
    system: int = 1
    open: str = ""
    number: int = 0
