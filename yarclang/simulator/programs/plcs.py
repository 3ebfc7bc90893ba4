"""The scans of all PLCs by the controller (TSRM 39-42).

PLC 0 is scanned at the real-time interrupt, PLCs 1 to 31 one after the other in the background.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from yarclang.simulator.programs import surroundings
from yarclang.simulator.programs.plc import Plc
from yarclang.simulator.state.registers import Variables

SCAN = 5e-3
"""Time between two scans of the background PLCs [s] (assumed; on a real controller it depends on the
load).
"""


class Surroundings(surroundings.Surroundings, Protocol):
    """The machine as PLCs see it."""

    @property
    def now(self) -> float:
        """Virtual time [s]."""
        ...


class Plcs:
    """All PLCs that were opened.

    If PLC 0 only computes variables, it is scanned only when one of these variables is read.

    Attributes:
        by_number: the PLCs.
    """

    def __init__(self, variables: Variables, outside: Surroundings) -> None:
        self.by_number: dict[int, Plc] = {}
        self._variables = variables
        self._outside = outside
        self._next_scan = math.inf
        self._next_interrupt = math.inf
        self._background: list[Plc] = []
        self._eager: Plc | None = None
        self._lazy: Plc | None = None
        self._refreshing = False
        variables.refresh = self._refresh

    @property
    def next_event(self) -> float:
        """Time of the next scan [s]."""
        return min(self._next_scan, self._next_interrupt)

    def handle(self) -> None:
        """Scan the PLCs that are due."""
        now = self._outside.now
        if now >= self._next_interrupt:
            self._next_interrupt = now + self._outside.interrupt
            if self._eager is not None:
                self._eager.scan(self._variables, self._outside)
        if now >= self._next_scan:
            self._next_scan = now + SCAN
            for plc in self._background:
                if plc.active:
                    plc.scan(self._variables, self._outside)

    def switch(self, name: str, numbers: Sequence[int]) -> None:
        """Execute ENABLE, DISABLE, PAUSE or RESUME. PLCs that don't exist are ignored."""
        for number in numbers:
            if (plc := self.by_number.get(number)) is None:
                continue
            match name:
                case "ENABLE":
                    plc.enable()
                case "DISABLE":
                    plc.disable()
                case _:
                    plc.paused = name == "PAUSE"
        self.changed()

    def changed(self) -> None:
        """Determine which PLCs are scanned. If PLC 0 only computes variables, its scan is postponed until one
        of these variables is read.
        """
        now, variables = self._outside.now, self._variables
        i5 = int(variables.i[5])
        foreground = self.by_number.get(0)
        self._eager = self._lazy = None
        variables.lazy = frozenset()
        if foreground is not None and foreground.active and i5 & 1:
            if results := foreground.results():
                self._lazy, variables.lazy = foreground, results
            else:
                self._eager = foreground
        self._background = [
            plc for number, plc in sorted(self.by_number.items()) if number and plc.active and i5 & 2
        ]
        if not self._background:
            self._next_scan = math.inf
        elif self._next_scan == math.inf:
            self._next_scan = now + SCAN
        if self._eager is None:
            self._next_interrupt = math.inf
        elif self._next_interrupt == math.inf:
            self._next_interrupt = now + self._outside.interrupt

    def _refresh(self) -> None:
        """Scan a postponed PLC 0 now, since one of its variables is about to be read."""
        if self._lazy is None or self._refreshing:
            return
        self._refreshing = True
        try:
            self._lazy.scan(self._variables, self._outside)
        finally:
            self._refreshing = False
