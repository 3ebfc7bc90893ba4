"""A leash, which limits the time by which a simulator may run ahead of the client in its process.

Simulator and client share one computer, which may be too busy to run either of them for a while. If the
machine's time followed the wall clock, the simulated controller would catch up as soon as it runs again, run
out of lines, and hold. On a leash, the controller's time waits for the client instead. The simulation is
slower, but otherwise unchanged.

A client that controls the leash (`Leash`) uses the machine's time as its own clock, and sets the time up to
which the machine may run. For any other client, the machine runs at most `AHEAD` beyond the last request.
"""

from __future__ import annotations

from collections.abc import Callable

AHEAD = 0.06
"""Time by which the machine may run ahead of the last request of a client that doesn't control the leash [s
of the machine].

It is more than the pause between two requests of any client that supervises a robot, which is at most 0.05 s.
It is less than the 0.1 s by which the guard PLC allows a client to be late.
"""

EXCHANGE = 0.02
"""Longest time between two steps of a client that controls the leash, at any rate [s of the machine].

With it, the longest series of requests between two resets of the watchdog takes less than half of the
watchdog's 0.4 s.
"""

_TICK = 0.005
_FINEST = 0.0005


def tick(rate: float) -> float:
    """Return the period at which the machine's time is advanced while no packets arrive [s of the wall
    clock].

    At a high rate the period is shorter, so that the machine's time advances by at most `EXCHANGE` at once,
    if the computer is fast enough.
    """
    return min(_TICK, max(EXCHANGE / rate, _FINEST))


class Leash:
    """The time of a simulated controller. Two threads share this object: the thread of the controller, and
    the thread of the client that controls the time.

    Each attribute is written by only one of the two threads.

    Args:
        rate: seconds of the machine's time per second.
        clock: function that returns the time of the wall clock [s], which all threads share.

    Attributes:
        until: time up to which the machine may run, set by the client [s]; None if no client controls the
            leash.
    """

    def __init__(self, rate: float, clock: Callable[[], float]) -> None:
        self.until: float | None = None
        self._rate = rate
        self._ahead = tick(rate)
        self._clock = clock
        self._told = (0.0, clock())
        self._stopped = False
        self._last = 0.0

    def tell(self, now: float) -> None:
        """Publish the machine's time [s]. To be called in the machine's thread."""
        self._told = now, self._clock()

    def stop(self) -> None:
        """From now on, let `now` follow the wall clock, since the machine has stopped. To be called in the
        machine's thread.
        """
        self._stopped = True

    def now(self) -> float:
        """Return the machine's time [s]. To be called in the client's thread.

        The returned time also advances between two ticks of the machine, and never goes back.
        """
        told, then = self._told
        passed = self._clock() - then
        now = told + self._rate * (passed if self._stopped else min(passed, self._ahead))
        if self.until is not None and not self._stopped:
            now = min(now, self.until)
        self._last = max(now, self._last)
        return self._last
