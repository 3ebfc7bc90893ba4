"""The time base of a coordinate system: program time as a function of real time (% command, feed hold)."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TimeMap:
    """Program time as a function of real time. Its rate is 1 at 100 %; it may change once, along a ramp.

    Attributes:
        since: real time at the start [s].
        program: program time at the start [s].
        first: rate at the start.
        last: rate after the change.
        slope: slope of the rate during the change [1/s].
    """

    since: float = 0.0
    program: float = 0.0
    first: float = 1.0
    last: float = 1.0
    slope: float = 1.0

    @property
    def settled(self) -> float:
        """Time at which the rate stops changing [s]."""
        return self.since + abs(self.last - self.first) / self.slope

    def rate(self, time: float) -> float:
        """Return the rate at a time [s]."""
        if self.first == self.last or time >= self.settled:
            return self.last
        return self.first + math.copysign(self.slope, self.last - self.first) * max(time - self.since, 0.0)

    def program_time(self, time: float) -> float:
        """Return the program time [s] at a time [s]."""
        passed = time - self.since
        if self.first == self.last:
            return self.program + self.last * passed
        changing = abs(self.last - self.first) / self.slope
        ramp = min(passed, changing)
        slope = math.copysign(self.slope, self.last - self.first)
        return self.program + self.first * ramp + slope * ramp**2 / 2.0 + self.last * (passed - ramp)

    def instant(self, program: float) -> float:
        """Return the real time at which program time reaches a value [s]; infinite if it never does."""
        ahead = program - self.program
        if ahead <= 0.0:
            return self.since
        if self.first == self.last:
            return self.since + ahead / self.last if self.last > 0.0 else math.inf
        changing = abs(self.last - self.first) / self.slope
        in_ramp = (self.first + self.last) / 2.0 * changing
        if ahead > in_ramp:
            return self.since + changing + (ahead - in_ramp) / self.last if self.last > 0.0 else math.inf
        slope = math.copysign(self.slope, self.last - self.first)
        root = math.sqrt(max(self.first**2 + 2.0 * slope * ahead, 0.0))
        # the root in a form without cancellation
        return self.since + 2.0 * ahead / (self.first + root)

    def towards(self, time: float, rate: float, slope: float) -> TimeMap:
        """Return the map of time after a change of the rate was requested.

        Args:
            time: start of the change [s].
            rate: the new rate.
            slope: slope of the rate during the change [1/s].
        """
        return TimeMap(time, self.program_time(time), self.rate(time), rate, max(slope, 1e-9))


def slew(i10: float, variable: float) -> float:
    """Return the slope of the time base's rate [1/s].

    The rate changes by Isx94 or Isx95 (`variable`) in each servo interrupt, in units of I10 (TSRM 177-193).
    """
    return max(variable, 1e-6) * 2.0**23 / max(i10, 1.0) ** 2 * 1e3
