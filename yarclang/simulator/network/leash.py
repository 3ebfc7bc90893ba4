"""How far a simulator in the process of its client may go ahead of it.

Both share one computer: where it has too much else to do, neither gets on. With the wall clock the simulated controller would go on all the same as soon as it
gets a turn, run out of lines, and hold. On a leash it waits for its client, and the time for which it waited is left out: the simulation is slower, and otherwise the same.

A client that takes the leash (`Leash`) has the machine's time for its own clock, and says up to when it may pass. For any other client the machine goes `AHEAD` of the last question at most.
"""

from __future__ import annotations

from collections.abc import Callable

AHEAD = 0.06
"""How far the machine may go ahead of what was asked last, by a client that doesn't take the leash: more than lies between two questions of any client that looks after a robot, whose longest pause is 0.05 s; less than the 0.1 s that the guard PLC allows a client to be late [s of the machine]."""

EXCHANGE = 0.02
"""Longest time of the machine from a step of the client that has the leash to the next one, at any rate [s of the machine]. The longest row of questions between two that wind the watchdog up takes less than half of its 0.4 s."""

_TICK = 0.005
_FINEST = 0.0005


def tick(rate: float) -> float:
    """Return how often time passes while no packets come [s of the wall clock]: at a great rate no more than `EXCHANGE` passes at once, if the computer is that quick."""
    return min(_TICK, max(EXCHANGE / rate, _FINEST))


class Leash:
    """The time of a machine, shared by the threads of the machine and of the client that has the leash.

    Each attribute is written by one of both threads alone.

    Args:
        rate: seconds of the machine a second.
        clock: that of the wall [s], the same in all threads.

    Attributes:
        until: up to when the machine's time may pass, set by the client [s]; None: nobody has the leash.
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
        """Tell the machine's time [s]. For the machine's thread."""
        self._told = now, self._clock()

    def stop(self) -> None:
        """Tell that the machine is gone: from now on the clock is that of the wall. For the machine's thread."""
        self._stopped = True

    def now(self) -> float:
        """Return the machine's time [s], which passes between two of its ticks, too, and never goes back. For the client's thread."""
        told, then = self._told
        passed = self._clock() - then
        now = told + self._rate * (passed if self._stopped else min(passed, self._ahead))
        if self.until is not None and not self._stopped:
            now = min(now, self.until)
        self._last = max(now, self._last)
        return self._last
