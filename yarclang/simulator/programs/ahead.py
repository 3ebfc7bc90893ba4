"""Steps of a motion program that are calculated before the motion needs them (TUM 339-341)."""

from __future__ import annotations

import math
from collections import deque
from typing import Protocol

from yarclang.simulator.motion.steps import Step
from yarclang.simulator.programs.calculation import Calculation

_AHEAD = 2
"""Number of steps that are calculated ahead of the motion (TUM 339: two in SPLINE, and in LINEAR without
segmentation).
"""


class Clock(Protocol):
    """Source of the time."""

    @property
    def now(self) -> float:
        """Virtual time [s]."""
        ...

    @property
    def interrupt(self) -> float:
        """Time between real-time interrupts [s]."""
        ...


class Ahead:
    """The steps of a motion program that are calculated but not begun.

    Attributes:
        steps: the steps, in the order of the program.
        calculating: True if more steps may be calculated.
        retry_at: time at which the calculation is tried again, if it could yield no step [s]; otherwise
            infinite.
        run_time_error: True if the calculation has failed since the last R.
    """

    def __init__(self, calculation: Calculation, clock: Clock) -> None:
        self._calculation = calculation
        self._clock = clock
        self.clear()

    def clear(self) -> None:
        """Return to the state at power-up."""
        self.run_time_error = False
        self.steps: deque[Step] = deque()
        self._left: float = 0
        self.stop()

    def leave(self) -> None:
        """Discard the calculated steps, and stop."""
        self.steps.clear()
        self.stop()

    def begin(self, single_step: bool) -> None:
        """Begin to calculate (R). If `single_step` is True, calculate at most one step (S)."""
        self.calculating, self.run_time_error = True, False
        self._left = 1 if single_step else math.inf

    def stop(self) -> None:
        """Stop calculating. The calculated steps are kept."""
        self.calculating = False
        self.retry_at = math.inf

    def fill(self) -> None:
        """Calculate steps until enough of them are ahead, or until no further step can be calculated at
        present.
        """
        steps = self.steps
        while self.calculating and len(steps) < _AHEAD and not (steps and steps[-1].breaks):
            if not self._left:
                self.calculating = False
                return
            step = self._calculation.step()
            if self._calculation.failed:
                self._calculation.failed = False
                self.run_time_error = True
                self.calculating = False
                return
            if step is None:
                if self._calculation.waiting:
                    grid = self._clock.interrupt
                    self.retry_at = (math.floor(self._clock.now / grid + 1e-9) + 1) * grid
                return
            steps.append(step)
            self._left -= 1
